// docs/types.md is what `quiver list --markdown` prints, and every element's fields are documented.
#include <fstream>
#include <sstream>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class TypesDocument : public CommandTest {};

TEST_F(TypesDocument, IsUpToDate) {
  std::ifstream file(QUIVER_TYPES_DOCUMENT);
  ASSERT_TRUE(file) << QUIVER_TYPES_DOCUMENT;
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), run("list --markdown").out) << "write it anew: quiver list --markdown > docs/types.md";
}

TEST_F(TypesDocument, EveryTagHasFieldsAndWords) {
  const Json list = Json::parse(run("list --json -").out);
  for (const char* kind : {"vertices", "edges", "parameters"}) {
    ASSERT_FALSE(list[kind].empty());
    for (const Json& type : list[kind]) {
      EXPECT_FALSE(type["fields"].empty()) << type["tag"];
      EXPECT_FALSE(type["documentation"].get<std::string>().empty()) << type["tag"];
    }
  }
}

}  // namespace
}  // namespace quiver::test
