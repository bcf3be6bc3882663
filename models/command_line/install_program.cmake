# wems_install_program(<target>): installs the executable under its prefix, its completion for bash, and, where help2man is
# found, a manual page made from its help.
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
    set(help_option --help)
    if(program STREQUAL "identify")
      set(help_option --help-all)
    endif()
    add_custom_command(OUTPUT ${folder}/${name}.1
      COMMAND ${HELP2MAN} --no-info --version-string=${PROJECT_VERSION} --source=WEMS --help-option=${help_option}
              --name=${PROJECT_DESCRIPTION} --output=${folder}/${name}.1 ${folder}/bin/${name}
      DEPENDS ${folder}/completions/${name} COMMENT "Manual page of ${name}" VERBATIM)
    list(APPEND documents ${folder}/${name}.1)
    install(FILES ${folder}/${name}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  endif()
  add_custom_target(documents_of_${program} ALL DEPENDS ${documents})
endfunction()
