"""MCAP files and what is inside: messages of ROS 2 and of JSON."""
