add_library(rclcpp::rclcpp INTERFACE IMPORTED)
include_directories(${CMAKE_CURRENT_LIST_DIR}/../include)
