"""ROS 2 messages without ROS: definitions as data, CDR by hand, whole columns of messages by numpy."""
