# wems_install_program(<target> [<command> …]): installs the executable under its prefix, its completion for bash, and, where
# help2man is found, manual pages made from its help and from that of each of its commands.
find_program(HELP2MAN help2man)

function(wems_install_program program)
  set(name ${WEMS_PROGRAM_PREFIX}${program})
  set(folder ${PROJECT_BINARY_DIR}/documents)
  install(PROGRAMS $<TARGET_FILE:${program}> DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME ${name})
  # The programs call themselves as they are called: through a link under the name that is installed.
  add_custom_command(OUTPUT ${folder}/completions/${name}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}/bin ${folder}/completions
    COMMAND ${CMAKE_COMMAND} -E create_symlink $<TARGET_FILE:${program}> ${folder}/bin/${name}
    COMMAND ${folder}/bin/${name} --completion ${name} > ${folder}/completions/${name}
    DEPENDS ${program} COMMENT "Completion of ${name}" VERBATIM)
  install(FILES ${folder}/completions/${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  set(documents ${folder}/completions/${name})
  if(HELP2MAN)
    foreach(command "" ${ARGN})
      string(JOIN "-" page ${name} ${command})
      string(JOIN " " call ${folder}/bin/${name} ${command})
      add_custom_command(OUTPUT ${folder}/${page}.1
        COMMAND ${CMAKE_COMMAND} -DHELP2MAN=${HELP2MAN} -DCALL=${call} -DVERSION=${PROJECT_VERSION}
                -DOUTPUT=${folder}/${page}.1 -P ${PROJECT_SOURCE_DIR}/models/command_line/make_manual.cmake
        DEPENDS ${folder}/completions/${name} ${PROJECT_SOURCE_DIR}/models/command_line/make_manual.cmake
        COMMENT "Manual page of ${page}" VERBATIM)
      list(APPEND documents ${folder}/${page}.1)
      install(FILES ${folder}/${page}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
    endforeach()
  endif()
  add_custom_target(documents_of_${program} ALL DEPENDS ${documents})
endfunction()
