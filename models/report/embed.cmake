# cmake -DOUTPUT=… -DDYGRAPHS=<folder> -DTHREE=<folder> -DSOURCE=<folder> -P embed.cmake: writes assets.cpp with the text of each asset.
# String literals are cut into pieces, since compilers limit their length.
function(embed name file result)
  file(READ "${file}" text)
  string(LENGTH "${text}" length)
  set(body "std::string ${name}() {\n    std::string text;\n")
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${text}" ${at} 8000 piece)
    string(APPEND body "    text += R\"~asset~(${piece})~asset~\";\n")
    math(EXPR at "${at} + 8000")
  endwhile()
  set(${result} "${body}    return text;\n}\n\n" PARENT_SCOPE)
endfunction()

embed(dygraphsScript "${DYGRAPHS}/dygraph.min.js" dygraphs_script)
embed(dygraphsStyle "${DYGRAPHS}/dygraph.min.css" dygraphs_style)
embed(threeScript "${THREE}/three.min.js" three_script)
embed(orbitControlsScript "${THREE}/examples/js/controls/OrbitControls.js" orbit_controls_script)
embed(stageScript "${SOURCE}/stage.js" stage_script)
embed(animationScript "${SOURCE}/animation.js" animation_script)
embed(surfaceScript "${SOURCE}/surface.js" surface_script)
embed(exportScript "${SOURCE}/export.js" export_script)
embed(pageScript "${SOURCE}/page.js" page_script)
embed(pageStyle "${SOURCE}/page.css" page_style)
file(WRITE "${OUTPUT}" "#include \"models/report/html_text.hpp\"\n\nnamespace wems::report_assets {\n\n"
  "${dygraphs_script}" "${dygraphs_style}" "${three_script}" "${orbit_controls_script}" "${stage_script}"
  "${animation_script}" "${surface_script}" "${export_script}" "${page_script}" "${page_style}" "}  // namespace wems::report_assets\n")
