/// @file
/// Text and numbers as parts of an HTML page and of its scripts.
#pragma once

#include <string>

namespace wems {

/// `&`, `<`, `>` and `"` as entities.
std::string escapeHtml(const std::string& text);

/// A JavaScript string literal; `<` is escaped so that no text can end the script element.
std::string quoteScript(const std::string& text);

/// Six significant digits; `NaN` for what is not finite.
std::string formatScriptNumber(double value);

}  // namespace wems

namespace wems::report_assets {

// Text of the front-end assets, put into the library at build time.

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
