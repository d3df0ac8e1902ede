# cmake -DBUILD_TREE=... -DGENERATOR=... -DCXX=... -P run.cmake: installs the build tree to a temporary prefix, then builds and
# runs a program against what was installed.
set(work ${BUILD_TREE}/installed_package_test)
file(REMOVE_RECURSE ${work})
function(step)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failed)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: ${failed}\n${output}")
  endif()
endfunction()
step(${CMAKE_COMMAND} --install ${BUILD_TREE} --prefix ${work}/prefix)
step(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
     -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=Release)
step(${CMAKE_COMMAND} --build ${work}/build)
step(${work}/build/uses_trigrain)
file(REMOVE_RECURSE ${work})
