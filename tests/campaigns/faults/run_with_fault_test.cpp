#include "tests/campaigns/faults/run_with_fault.h"

#include <algorithm>
#include <cerrno>
#include <string>

#include <gmock/gmock.h>

#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Effect = FileCall::Effect;
using NameUse = FileCall::NameUse;

/// A folder with a file to read and one to write, of the letters a to t, five times.
class RunWithFault : public testing::Test {
 protected:
  RunWithFault() {
    for (int n = 0; n < 100; ++n) letters_ += static_cast<char>('a' + n % 20);
    restore();
  }
  void restore() const {
    write_bytes(folder_ / "in", letters_);
    write_bytes(folder_ / "out", letters_);
    fs::remove(folder_ / "new");
  }
  [[nodiscard]] FaultyRun run(const std::string& call, std::size_t number = kNoCall,
                              const Fault& fault = {}) const {
    restore();
    return run_with_fault({SPLATLAS_ONE_FILE_CALL, call}, folder_, Naming::kUnnamed, number, fault);
  }
  /// The place of the first call of this name; kNoCall if there is none.
  [[nodiscard]] static std::size_t find(const FaultyRun& run, const std::string& name) {
    const auto found = std::ranges::find(run.calls, name, &FileCall::name);
    return found == run.calls.end() ? kNoCall : static_cast<std::size_t>(found - run.calls.begin());
  }
  [[nodiscard]] std::string written() const { return read_bytes(folder_ / "out"); }

  TemporaryFolder temporary_;
  fs::path folder_ = fs::canonical(temporary_.path());
  std::string letters_;
};

TEST_F(RunWithFault, SeesEveryCallThatReadsOrChangesFiles) {
  struct Seen {
    const char *program, *call, *file;
    Effect effect;
    NameUse use = NameUse::kNone;
  };
  for (const Seen& seen :
       {Seen{"readv", "readv", "in", Effect::kReads}, Seen{"preadv", "preadv", "in", Effect::kReads},
        Seen{"preadv2", "preadv2", "in", Effect::kReads}, Seen{"writev", "writev", "out", Effect::kStores},
        Seen{"pwritev", "pwritev", "out", Effect::kStores},
        Seen{"pwritev2", "pwritev2", "out", Effect::kStores},
        Seen{"sendfile", "sendfile", "out", Effect::kStores},
        Seen{"copy_file_range", "copy_file_range", "out", Effect::kStores},
        Seen{"mmap", "mmap", "out", Effect::kStores},
        Seen{"fchmodat2", "fchmodat2", "out", Effect::kChanges, NameUse::kChanges},
        Seen{"utimensat", "utimensat", "out", Effect::kChanges, NameUse::kChanges},
        Seen{"utimensat of a descriptor", "utimensat", "out", Effect::kChanges, NameUse::kChanges},
        Seen{"openat2", "openat2", "new", Effect::kStores, NameUse::kCreates}}) {
    const FaultyRun usual = run(seen.program);
    const std::size_t n = find(usual, seen.call);
    ASSERT_NE(n, kNoCall) << seen.program;
    EXPECT_EQ(usual.calls[n].path, folder_ / seen.file) << seen.program;
    EXPECT_EQ(usual.calls[n].effect, seen.effect) << seen.program;
    EXPECT_EQ(usual.calls[n].use, seen.use) << seen.program;
    const FaultyRun failed = run(seen.program, n, {Fault::Kind::kError, EIO, false, ""});
    EXPECT_EQ(failed.result.out, seen.program == std::string("mmap") ? "-5" : std::to_string(-EIO))
        << seen.program;
  }
  EXPECT_EQ(find(run("mmap for reading"), "mmap"), kNoCall);
}

TEST_F(RunWithFault, CutsTransfersShort) {
  for (const std::string call :
       {"read", "pread", "readv", "preadv", "preadv2", "write", "pwrite", "writev", "pwritev", "pwritev2"}) {
    const bool is_at_position = call == "pread" || call == "preadv" || call == "pwrite" || call == "pwritev";
    const FaultyRun usual = run(call);
    EXPECT_EQ(usual.result.out,
              is_at_position && usual.calls[find(usual, call)].effect == Effect::kReads ? "80" : "100")
        << call;
    const FaultyRun cut = run(call, find(usual, call), {Fault::Kind::kShort, 0, false, ""});
    EXPECT_EQ(cut.result.out, "50") << call;
    if (usual.calls[find(usual, call)].effect == Effect::kReads) continue;
    const std::size_t at = is_at_position ? 20 : 0;
    EXPECT_EQ(written(), letters_.substr(0, at) + std::string(50, 'x') + letters_.substr(at + 50)) << call;
  }
}

}  // namespace
}  // namespace splatlas
