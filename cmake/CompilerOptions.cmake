# Warnings are errors for those who work on this package, and in continuous integration: other compilers than
# theirs know warnings that nobody has seen yet, and a user's build must not fail for them.
option(RGBD_SFM_FUSION_WARNINGS_AS_ERRORS "A warning of our own code fails the build" OFF)

# Linked PRIVATE, so that they stay ours.
add_library(${PROJECT_NAME}_warnings INTERFACE)
target_compile_options(${PROJECT_NAME}_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Wnon-virtual-dtor
  -Woverloaded-virtual -Wdouble-promotion $<$<BOOL:${RGBD_SFM_FUSION_WARNINGS_AS_ERRORS}>:-Werror>)
