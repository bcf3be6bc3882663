# cmake -DOUTPUT=… -DSOURCE=<folder> "-DNAMES=<command> …" -P embed.cmake: writes schemas.cpp with the text of each schema.
separate_arguments(names UNIX_COMMAND "${NAMES}")
set(rows "")
foreach(name ${names})
  file(READ "${SOURCE}/${name}.json" text)
  string(APPEND rows "        {\"${name}\", R\"~schema~(${text})~schema~\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"identify/commands/schemas.hpp\"\n\nnamespace wems::identify::commands {\n\n"
  "const std::map<std::string, std::string>& schemaTexts() {\n    static const std::map<std::string, std::string> texts{\n${rows}    };\n    return texts;\n}\n\n"
  "}  // namespace wems::identify::commands\n")
