# Writes a C++ source that holds shader files as string constants.
# Usage: cmake -DOUTPUT=file.cpp -DINPUTS=a.vert,b.frag -P embed_shaders.cmake
string(REPLACE "," ";" inputs "${INPUTS}")
set(text "#include \"gl/shaders.hpp\"\n\nnamespace hemi::gl::shaders {\n")
foreach(input IN LISTS inputs)
    get_filename_component(name "${input}" NAME)
    string(REPLACE "." "_" name "${name}")
    file(READ "${input}" source)
    string(APPEND text "const char* const ${name} = R\"GLSL(${source})GLSL\";\n")
endforeach()
string(APPEND text "} // namespace hemi::gl::shaders\n")
file(WRITE "${OUTPUT}" "${text}")
