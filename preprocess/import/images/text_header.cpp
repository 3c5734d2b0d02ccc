#include "preprocess/import/images/text_header.h"

#include <algorithm>

#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<TextHeader> read_text_header(const std::filesystem::path& path, std::size_t max_bytes,
                                    HeaderLine (*parse_line)(std::string_view line)) {
  using Kind = HeaderLine::Kind;
  const std::string text = first_bytes(path, max_bytes);
  TextHeader header;
  for (HeaderLine line{Kind::kComment, {}, {}};
       line.kind != Kind::kEnd && line.kind != Kind::kLastField && header.bytes < text.size();) {
    const std::size_t end = std::min(text.find('\n', header.bytes), text.size());
    line = parse_line(std::string_view(text).substr(header.bytes, end - header.bytes));
    header.bytes = std::min(end + 1, text.size());
    const bool is_field = line.kind == Kind::kField || line.kind == Kind::kLastField;
    if (is_field && !header.fields.emplace(line.field, line.value).second)
      return bad_file(path, "says '{}' twice in its header", line.field);
  }
  return header;
}

}  // namespace splatlas
