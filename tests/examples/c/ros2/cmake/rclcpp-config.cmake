include_directories(${CMAKE_CURRENT_LIST_DIR}/../include)
