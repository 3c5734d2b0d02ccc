# Installs BUILD_DIR into WORK_DIR, builds examples/ against the installed package only, runs every example, and
# compares pictures with those of the installed splatlas-player.
# Variables: BUILD_DIR, SOURCE_DIR, PHANTOM_ATLAS (the program that writes the phantom), WORK_DIR, CXX_COMPILER,
# BUILD_TYPE, PKG_CONFIG (the program), PKG_CONFIG_FOLDER (of splatlas.pc, below the prefix).

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

# expect_damage(COMMAND...): exit status 1, and all output is messages that name the missing structure.
function(expect_damage)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE message)
  if(NOT status EQUAL 1 OR NOT output STREQUAL "" OR NOT message MATCHES "\"Sphere_1\": its surface is missing")
    message(FATAL_ERROR "${ARGN}: exit status ${status}, output: ${output}, message: ${message}")
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

# The same picture without CMake: one command with the flags of pkg-config.
execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${WORK_DIR}/prefix/${PKG_CONFIG_FOLDER}
  ${PKG_CONFIG} --cflags --libs splatlas OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND ${flags})
run(${CXX_COMPILER} -std=c++20 ${SOURCE_DIR}/examples/render_picture.cpp -o ${WORK_DIR}/without_cmake ${flags})
run(${WORK_DIR}/without_cmake ${phantom} Spheres:both ${WORK_DIR}/without_cmake.png)
expect_picture(${WORK_DIR}/without_cmake.png ${phantom} --select Spheres:both --view left)

# Failures print one line and leave no files.
set(render ${examples}/render_picture)
expect_failure(1 "missing\\.atlas" ${render} ${WORK_DIR}/missing.atlas Spheres ${WORK_DIR}/none.png)
expect_failure(1 "Sphere_3" ${render} ${phantom} Sphere_3 ${WORK_DIR}/none.png)
expect_failure(1 "no_folder" ${render} ${phantom} Spheres ${WORK_DIR}/no_folder/none.png)
file(GLOB left ${WORK_DIR}/*none*)
if(left)
  message(FATAL_ERROR "left behind: ${left}")
endif()

# Damage: a message and exit status 1. The picture shows the intact structures.
set(damaged ${WORK_DIR}/damaged.atlas)
run(${PHANTOM_ATLAS} ${damaged} damaged)
expect_damage(${render} ${damaged} "*:surface" ${WORK_DIR}/damaged.png)
expect_picture(${WORK_DIR}/damaged.png ${phantom} --view left --select Sphere_2:surface)
expect_damage(${examples}/pick_structure ${damaged} "*:surface" 320 240)
execute_process(COMMAND ${examples}/change_selection ${damaged} Sphere_2 ${WORK_DIR}/damaged OUTPUT_QUIET
  RESULT_VARIABLE status ERROR_VARIABLE message)
if(NOT status EQUAL 1 OR NOT message MATCHES "\"Sphere_1\": its surface is missing")
  message(FATAL_ERROR "change_selection of a damaged atlas: exit status ${status}, message: ${message}")
endif()

# An atlas without structures.
set(empty ${WORK_DIR}/empty.atlas)
run(${PHANTOM_ATLAS} ${empty} empty)
run(${render} ${empty} "*" ${WORK_DIR}/empty.png)
expect_picture(${WORK_DIR}/empty.png ${empty} --view left)
expect_failure(1 "no structure is called" ${examples}/change_selection ${empty} "*" ${WORK_DIR}/none)

# Annotated pages, through both modules: the program draws the same.
foreach(ending png tif pdf svg)
  run(${examples}/render_page ${phantom} Spheres ${WORK_DIR}/page.${ending})
  run(${WORK_DIR}/prefix/bin/splatlas-player render ${phantom} -o ${WORK_DIR}/player.${ending} --select Spheres --view left
    --size 1654x1169 --dpi 200 --background "#ffffff" --annotate labels,legend,scalebar,caption --caption Spheres)
  run(${CMAKE_COMMAND} -E compare_files ${WORK_DIR}/page.${ending} ${WORK_DIR}/player.${ending})
endforeach()
expect_failure(1 "unknown picture ending '\\.bmp'" ${examples}/render_page ${phantom} Spheres ${WORK_DIR}/page.bmp)

# A changed selection, and its transfer function.
expect_output("grey 0: opacity 0\ngrey 123\\.75: opacity 0\ngrey 126\\.25: opacity 0\\.5\ngrey 250: opacity 0\\.5\n"
  ${examples}/change_selection ${phantom} Sphere_2 ${WORK_DIR}/changed)
expect_picture(${WORK_DIR}/changed-1.png ${phantom}
  --select "*:surface(opacity=0.1) - Sphere_2 + Sphere_2:volume(opacity=0.5,profile=hard)")

# The nearest point of a ball, straight on; its surface is half a voxel from its outermost voxels' centres.
expect_output("Sphere_[12] at L [0-9.]+ P [0-9.]+ S [0-9.]+ mm\nshown at 320\\.0, 240\\.0, -?[0-9.]+ mm behind the centre\n"
  ${examples}/pick_structure ${phantom} Sphere_1:surface 320 240)
expect_output("background\n" ${examples}/pick_structure ${phantom} "*:surface" 1 1)
expect_failure(1 "X and Y must be numbers: abc" ${examples}/pick_structure ${phantom} "*:surface" abc 240)
expect_failure(1 "X and Y must be numbers: 240x" ${examples}/pick_structure ${phantom} "*:surface" 320 240x)

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

# If SDL2 is installed, the viewer without a screen. SDL turns the interrupt into the event of a closed window.
if(EXISTS ${examples}/viewer)
  set(viewer ${CMAKE_COMMAND} -E env SDL_VIDEODRIVER=dummy timeout --preserve-status --signal INT 2 ${examples}/viewer)
  run(${viewer} ${phantom})
  run(${viewer} ${empty})
  expect_failure(1 "usage: viewer" ${viewer})
  expect_failure(1 "missing\\.atlas" ${viewer} ${WORK_DIR}/missing.atlas)
  expect_failure(1 "viewer: [^\n]*no_driver" ${CMAKE_COMMAND} -E env SDL_VIDEODRIVER=no_driver
    ${examples}/viewer ${phantom})
endif()
