# Installs BUILD_DIR into WORK_DIR, builds the consumer project against that and runs it.
# Variables: BUILD_DIR, SOURCE_DIR (of the consumer), WORK_DIR, CXX_COMPILER, BUILD_TYPE.

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G Ninja --log-level=NOTICE
  -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)

# No atlas there: the library says so in one line, with the status that the programs document.
execute_process(COMMAND ${WORK_DIR}/build/consumer ${WORK_DIR}/missing.atlas
  RESULT_VARIABLE status ERROR_VARIABLE message)
if(NOT status EQUAL 1 OR NOT message MATCHES "^[^\n]*missing\\.atlas[^\n]*\n$")
  message(FATAL_ERROR "consumer: exit status ${status}, message: ${message}")
endif()
