# Installs the build tree into a folder of its own, builds the consumer against that and runs it.
#   cmake -DBUILD=… -DSOURCE=… -DWORK=… -DCONFIG=… -DCOMPILER=… -DFLAGS=… -DGENERATOR=… -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/installed --config ${CONFIG})
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${CONFIG}
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_PREFIX_PATH=${WORK}/installed)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/trolley)
message("${output}")
# By hand: 12 kg on 4 x 17 000 N/m sag by m g / k, each isolator carries a quarter of the weight, and half of the potential
# energy that is lost is dissipated.
run(${WORK}/build/settle ${WORK}/installed/share/wems/models/box_on_isolators.toml)
message("${output}")
if(NOT output MATCHES "connection 1: -1.731. mm, -29.43 N; dissipated 0.1019 J")
  message(FATAL_ERROR "not -1.7312 mm, -29.43 N, 0.1019 J: ${output}")
endif()
# The installed programs start, under their prefix.
foreach(program simulate identify)
  run(${WORK}/installed/bin/${PREFIX}${program} --help)
  run(bash -n ${WORK}/installed/share/bash-completion/completions/${PREFIX}${program})
endforeach()
