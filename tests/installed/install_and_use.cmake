# Installs BUILD_DIR into WORK_DIR, builds examples/ against the installed package only, runs every example, and
# compares pictures with those of the installed splatlas-player.
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

# expect_output(PATTERN COMMAND...): succeeds, and all of its output matches.
function(expect_output pattern)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  if(NOT output MATCHES "^${pattern}$")
    message(FATAL_ERROR "${ARGN}: ${output}")
  endif()
endfunction()

# expect_picture(FILE ATLAS OPTIONS...): the same bytes as the program's picture of the atlas.
function(expect_picture file atlas)
  run(${WORK_DIR}/prefix/bin/splatlas-player render ${atlas} -o ${WORK_DIR}/player.png --size 640x480 ${ARGN})
  run(${CMAKE_COMMAND} -E compare_files ${file} ${WORK_DIR}/player.png)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
build_against_prefix(${SOURCE_DIR}/examples examples)
build_against_prefix(${SOURCE_DIR}/tests/installed/headers headers)
set(examples ${WORK_DIR}/examples)
set(phantom ${WORK_DIR}/phantom.atlas)
run(${PHANTOM_ATLAS} ${phantom})

# Pictures of several selections.
foreach(selection "Sphere_1:surface(opacity=0.5) + Sphere_2" "Spheres:both" "Sphere_1 - Sphere_1")
  run(${examples}/render_picture ${phantom} ${selection} ${WORK_DIR}/example.png)
  expect_picture(${WORK_DIR}/example.png ${phantom} --select ${selection} --view left)
  file(SHA256 ${WORK_DIR}/example.png hash)
  list(APPEND hashes ${hash})
endforeach()
list(REMOVE_DUPLICATES hashes)
list(LENGTH hashes pictures)
if(NOT pictures EQUAL 3)
  message(FATAL_ERROR "three selections give ${pictures} pictures")
endif()

# Failures print one line and leave no files.
set(render ${examples}/render_picture)
expect_failure(1 "missing\\.atlas" ${render} ${WORK_DIR}/missing.atlas Spheres ${WORK_DIR}/none.png)
expect_failure(1 "Sphere_3" ${render} ${phantom} Sphere_3 ${WORK_DIR}/none.png)
expect_failure(1 "no_folder" ${render} ${phantom} Spheres ${WORK_DIR}/no_folder/none.png)
file(GLOB left ${WORK_DIR}/*none*)
if(left)
  message(FATAL_ERROR "left behind: ${left}")
endif()

# A changed selection, and its transfer function.
expect_output("grey 0: opacity 0\ngrey 123\\.75: opacity 0\ngrey 126\\.25: opacity 0\\.5\ngrey 250: opacity 0\\.5\n"
  ${examples}/change_selection ${phantom} Sphere_2 ${WORK_DIR}/changed)
expect_picture(${WORK_DIR}/changed-1.png ${phantom}
  --select "*:surface(opacity=0.1) - Sphere_2 + Sphere_2:volume(opacity=0.5,profile=hard)")

# The nearest point of a ball, straight on; its surface is half a voxel from its outermost voxels' centres.
expect_output("Sphere_[12] at L [0-9.]+ P [0-9.]+ S [0-9.]+ mm\nshown at 320\\.0, 240\\.0, -?[0-9.]+ mm behind the centre\n"
  ${examples}/pick_structure ${phantom} Sphere_1:surface 320 240)
expect_output("background\n" ${examples}/pick_structure ${phantom} "*:surface" 1 1)

# The same voxel counts as the program.
execute_process(COMMAND ${WORK_DIR}/prefix/bin/splatlas-player info --json ${phantom} OUTPUT_VARIABLE info
  COMMAND_ERROR_IS_FATAL ANY)
string(JSON structures LENGTH ${info} structures)
math(EXPR last "${structures} - 1")
foreach(s RANGE ${last})
  string(JSON id GET ${info} structures ${s} id)
  string(JSON interior GET ${info} structures ${s} voxels interior)
  string(JSON boundary GET ${info} structures ${s} voxels boundary)
  math(EXPR voxels "${interior} + ${boundary}")
  expect_output("${id}: ${voxels} voxels, [0-9.]+ ml, mean grey value [0-9.]+\n" ${examples}/read_voxels ${phantom} ${id})
endforeach()

# An atlas from arrays in memory.
run(${examples}/write_atlas ${WORK_DIR}/ball.atlas)
run(${WORK_DIR}/prefix/bin/splatlas-player verify ${WORK_DIR}/ball.atlas)
run(${examples}/render_picture ${WORK_DIR}/ball.atlas Ball ${WORK_DIR}/ball.png)
expect_picture(${WORK_DIR}/ball.png ${WORK_DIR}/ball.atlas --view left)

# If SDL2 is installed, the viewer without a screen: 120 of 480 pixels turn the camera by 45 degrees.
if(EXISTS ${examples}/viewer)
  file(WRITE ${WORK_DIR}/script "drag 120 0\nclick 320 240\nkey T\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -E env SDL_VIDEODRIVER=dummy
    ${examples}/viewer ${phantom} ${WORK_DIR}/script ${WORK_DIR}/viewer.png
    OUTPUT_VARIABLE clicked OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(NOT clicked MATCHES "^Sphere_[12]$")
    message(FATAL_ERROR "the viewer tells of a click: ${clicked}")
  endif()
  expect_picture(${WORK_DIR}/viewer.png ${phantom} --azimuth -45 --select "*:surface - ${clicked}")
endif()

# If splatlas-preprocess is installed too: the phantom, from its files to a picture.
set(preprocess ${WORK_DIR}/prefix/bin/splatlas-preprocess)
if(EXISTS ${preprocess})
  set(files ${WORK_DIR}/phantom)
  run(${BUILD_DIR}/bin/splatlas-phantom ${files})
  run(${preprocess} build -o ${files}_built.atlas --labels ${files}/labels.nrrd --volume ${files}/volume.nrrd
    --names ${files}/names.txt --tree ${files}/phantom.tree)
  run(${render} ${files}_built.atlas Phantom:both ${WORK_DIR}/example.png)
endif()
