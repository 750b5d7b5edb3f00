// What the example uses of a message of ROS 2.
#pragma once
namespace std_msgs::msg
{
struct Bool
{
  bool data = false;
};
}  // namespace std_msgs::msg
