/// @file
/// Text of the front-end assets, put into the library at build time.
#pragma once

#include <string>

namespace wems::report_assets {

std::string dygraphsScript();
std::string dygraphsStyle();
std::string threeScript();
std::string orbitControlsScript();
std::string stageScript();
std::string animationScript();
std::string surfaceScript();
std::string exportScript();
std::string pageScript();
std::string pageStyle();

}  // namespace wems::report_assets
