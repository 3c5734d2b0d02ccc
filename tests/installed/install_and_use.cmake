# Installs BUILD_DIR into WORK_DIR, builds docs/example against that and nothing else, and compares its pictures with
# those of the installed splatlas-player.
# Variables: BUILD_DIR, SOURCE_DIR, PHANTOM_ATLAS (the program that writes the phantom), WORK_DIR, CXX_COMPILER,
# BUILD_TYPE.

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# build_against_prefix(SOURCE NAME): a project that finds the installed package, in WORK_DIR/NAME.
function(build_against_prefix source name)
  run(${CMAKE_COMMAND} -S ${source} -B ${WORK_DIR}/${name} -G Ninja --log-level=NOTICE
    -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/${name})
endfunction()

# expect_failure(STATUS PATTERN COMMAND...): ends with this status, and one line on standard error.
function(expect_failure expected pattern)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status ERROR_VARIABLE message)
  if(NOT status EQUAL ${expected} OR NOT message MATCHES "^[^\n]*${pattern}[^\n]*\n$")
    message(FATAL_ERROR "${ARGN}: exit status ${status}, message: ${message}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
build_against_prefix(${SOURCE_DIR}/docs/example example)
build_against_prefix(${SOURCE_DIR}/tests/installed/headers headers)
set(example ${WORK_DIR}/example/render_selection)

# The same bytes as the program's, whatever is selected.
run(${PHANTOM_ATLAS} ${WORK_DIR}/phantom.atlas)
foreach(selection "Sphere_1:surface(opacity=0.5) + Sphere_2" "Spheres:both" "Sphere_1 - Sphere_1")
  run(${example} ${WORK_DIR}/phantom.atlas ${selection} ${WORK_DIR}/example.png)
  run(${WORK_DIR}/prefix/bin/splatlas-player render ${WORK_DIR}/phantom.atlas -o ${WORK_DIR}/player.png
    --select ${selection} --view left --size 640x480)
  run(${CMAKE_COMMAND} -E compare_files ${WORK_DIR}/example.png ${WORK_DIR}/player.png)
  file(SHA256 ${WORK_DIR}/example.png hash)
  list(APPEND hashes ${hash})
endforeach()
list(REMOVE_DUPLICATES hashes)
list(LENGTH hashes pictures)
if(NOT pictures EQUAL 3)
  message(FATAL_ERROR "three selections give ${pictures} pictures")
endif()

# Failures are told in one line, and leave nothing behind.
expect_failure(1 "missing\\.atlas" ${example} ${WORK_DIR}/missing.atlas Spheres ${WORK_DIR}/none.png)
expect_failure(1 "Sphere_3" ${example} ${WORK_DIR}/phantom.atlas Sphere_3 ${WORK_DIR}/none.png)
expect_failure(1 "no_folder" ${example} ${WORK_DIR}/phantom.atlas Spheres ${WORK_DIR}/no_folder/none.png)
file(GLOB left ${WORK_DIR}/*none*)
if(left)
  message(FATAL_ERROR "left behind: ${left}")
endif()

# Where the offline side is installed too: the phantom, from its files to a picture.
set(preprocess ${WORK_DIR}/prefix/bin/splatlas-preprocess)
if(EXISTS ${preprocess})
  set(phantom ${WORK_DIR}/phantom)
  run(${BUILD_DIR}/bin/splatlas-phantom ${phantom})
  run(${preprocess} build -o ${phantom}.atlas --labels ${phantom}/labels.nrrd --volume ${phantom}/volume.nrrd
    --names ${phantom}/names.txt --tree ${phantom}/phantom.tree)
  run(${example} ${phantom}.atlas Phantom:both ${WORK_DIR}/example.png)
endif()
