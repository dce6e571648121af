// A plugin that calls what no library has.
#include <quiver/plugins/plugin.h>

void functionOfNoLibrary();

namespace {

void registerNothing(quiver::Registry&) { functionOfNoLibrary(); }

}  // namespace

QUIVER_PLUGIN(registerNothing);
