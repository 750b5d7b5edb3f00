// What the example uses of a message of ROS 2.
#pragma once
namespace std_msgs::msg
{
struct Float64
{
  double data = 0.0;
};
}  // namespace std_msgs::msg
