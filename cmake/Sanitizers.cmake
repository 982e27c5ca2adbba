# -DRGBD_SFM_FUSION_SANITIZE=address,undefined or =thread: everything built checks itself as it runs.
set(RGBD_SFM_FUSION_SANITIZE "" CACHE STRING "Sanitizers: address,undefined or thread; empty for none")
if(RGBD_SFM_FUSION_SANITIZE)
  add_compile_options(-fsanitize=${RGBD_SFM_FUSION_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
    # With these tests at each access no loop uses vectors. The fuzz targets keep them.
    -fno-sanitize=null,object-size,alignment)
  add_link_options(-fsanitize=${RGBD_SFM_FUSION_SANITIZE})
endif()
