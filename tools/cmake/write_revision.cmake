# Writes a C++ source that names the git revision, when that has changed. Without git, or outside a
# repository of its own, the revision is unknown.
# Usage: cmake -DOUTPUT=file.cpp -DSOURCE=folder -P write_revision.cmake
set(revision "")
if(EXISTS ${SOURCE}/.git)
    execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
        OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
endif()
if(NOT revision)
    set(revision unknown)
endif()
set(text "#include \"cli/arguments/version.hpp\"\n\nconst char* const hemi::cli::source_revision = \"${revision}\";\n")
if(EXISTS ${OUTPUT})
    file(READ ${OUTPUT} previous)
endif()
if(NOT "${previous}" STREQUAL "${text}")
    file(WRITE ${OUTPUT} "${text}")
endif()
