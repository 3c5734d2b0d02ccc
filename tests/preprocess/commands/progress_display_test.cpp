#include <chrono>
#include <memory>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "preprocess/commands/commands.h"

namespace splatlas {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Output of a build of two stages, which report their own begin and end.
std::string shown(ProgressMode mode) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::tmpfile());
  ProgressDisplay display(mode, file.get());
  StageClock clock([&](const BuildProgress& progress) { display.show(progress); });
  for (const std::string stage : {"segment", "write"}) {
    clock.begin(stage, 0.5);
    clock.update(0);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));  // longer than the display's pause
    clock.update(0.5);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    clock.update(1);
  }
  clock.end();
  display.finish();
  std::string text(static_cast<std::size_t>(std::ftell(file.get())), '\0');
  std::rewind(file.get());
  EXPECT_EQ(std::fread(text.data(), 1, text.size(), file.get()), text.size());
  return text;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(ProgressDisplay, ALineIsRewrittenUntilItsEnd) {
  const std::string text = shown(ProgressMode::kPercent);
  for (const std::string percent : {"   0 %", "  50 %", " 100 %"})
    EXPECT_EQ(count(text, percent), 2u) << text;
  EXPECT_EQ(count(text, "\n"), 2u);
  EXPECT_EQ(count(text, "\r"), 6u);
}

TEST(ProgressDisplay, ALinePerStageWhenItHasEnded) {
  const std::string text = shown(ProgressMode::kLines);
  EXPECT_EQ(count(text, "\n"), 2u);
  EXPECT_THAT(text, testing::MatchesRegex("segment +0\\.[0-9]+ s\nwrite +0\\.[0-9]+ s\n"));
}

TEST(ProgressDisplay, JsonTellsEveryFractionOnce) {
  std::vector<std::pair<std::string, double>> told;
  std::istringstream lines(shown(ProgressMode::kJson));
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line);
    told.emplace_back(json.at("stage"), json.at("stage_fraction"));
  }
  EXPECT_EQ(
      told,
      (std::vector<std::pair<std::string, double>>{
          {"segment", 0}, {"segment", 0.5}, {"segment", 1}, {"write", 0}, {"write", 0.5}, {"write", 1}}));
}

}  // namespace
}  // namespace splatlas
