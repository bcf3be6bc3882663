# cmake -DHELP2MAN=… -DCALL=<program and command> -DVERSION=… -DOUTPUT=… -P make_manual.cmake: a manual page made from the help, whose
# first line says what the program does and becomes the line NAME.
string(REPLACE " " ";" call "${CALL}")
execute_process(COMMAND ${call} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "^[^\n]+" name "${help}")
string(REGEX REPLACE "\\.$" "" name "${name}")
string(SUBSTRING "${name}" 0 1 initial)
string(SUBSTRING "${name}" 1 -1 rest)
string(TOLOWER "${initial}" initial)
execute_process(
  COMMAND ${HELP2MAN} --no-info --version-string=${VERSION} --source=WEMS --name=${initial}${rest} --output=${OUTPUT} ${CALL}
  COMMAND_ERROR_IS_FATAL ANY)
# Title and index want the page's own name, with a dash where the call has a space.
get_filename_component(page "${OUTPUT}" NAME_WLE)
string(TOUPPER "${page}" title)
file(READ "${OUTPUT}" manual)
string(REGEX REPLACE "(\n\\.SH NAME\n)[^\n]* \\\\- " "\\1${page} \\\\- " manual "${manual}")
string(REGEX REPLACE "(\n\\.TH )[^\"]*\"1\"" "\\1${title} \"1\"" manual "${manual}")
file(WRITE "${OUTPUT}" "${manual}")
