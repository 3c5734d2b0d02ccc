# Installs BUILD_DIR into WORK_DIR, builds the consumer project against that, and runs it and the installed programs.
# Variables: BUILD_DIR, SOURCE_DIR (of the consumer), WORK_DIR, CXX_COMPILER, BUILD_TYPE.

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(expect_output pattern)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
  if(NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "output '${output}' is not '${pattern}'")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G Ninja --log-level=NOTICE
  -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
set(consumer ${WORK_DIR}/build/consumer)

# No atlas there: the library says so in one line, with the status that the programs document.
execute_process(COMMAND ${consumer} ${WORK_DIR}/missing.atlas "" RESULT_VARIABLE status ERROR_VARIABLE message)
if(NOT status EQUAL 1 OR NOT message MATCHES "^[^\n]*missing\\.atlas[^\n]*\n$")
  message(FATAL_ERROR "consumer: exit status ${status}, message: ${message}")
endif()

# Where the offline side is installed too: the phantom, from its files to pictures.
set(preprocess ${WORK_DIR}/prefix/bin/splatlas-preprocess)
if(EXISTS ${preprocess})
  set(phantom ${WORK_DIR}/phantom)
  run(${BUILD_DIR}/bin/splatlas-phantom ${phantom})
  run(${preprocess} build -o ${phantom}.atlas --labels ${phantom}/labels.nrrd --volume ${phantom}/volume.nrrd
    --names ${phantom}/names.txt --tree ${phantom}/phantom.tree)
  run(${WORK_DIR}/prefix/bin/splatlas-player render ${phantom}.atlas -o ${phantom}.png --select Phantom)
  expect_output("^0 %\n$" ${consumer} ${phantom}.atlas "Phantom - Phantom")  # a function drops empty words
  expect_output("^[1-9][0-9]? %\n$" ${consumer} ${phantom}.atlas Phantom:both)
endif()
