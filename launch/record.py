#!/usr/bin/python3
"""Records a run: rosbag record with the topics of a node that is just starting.

record.py NODE     NODE: name of the monolith_tank_node; MONOLITH_TANK_BAG in the environment: the bag

The path is not an argument because roslaunch would split it at blanks. rosbag's own way of finding topics looks once
a second of ROS time, which stands still until the node starts.
"""

import os
import sys
import time

import rosgraph
import rosgraph.names
import roslib.packages

POLL_SEC = 0.05
COMMON = ['/clock', '/tf', '/tf_static', '/diagnostics']


def nodeTopics(node):
    """What the node publishes and listens to under its own name; nothing until it has advertised everything."""
    publishers, subscribers, services = rosgraph.Master('/monolith_tank_record').getSystemState()
    # The node advertises this service last.
    if node + '/step' not in [name for name, _ in services]:
        return None
    return sorted({name for name, _ in publishers + subscribers if name.startswith(node + '/')})


def main():
    bag = os.environ.get('MONOLITH_TANK_BAG')
    if len(sys.argv) < 2 or not bag:
        sys.exit('record.py: expected the name of a node as argument and the path of a bag in MONOLITH_TANK_BAG')
    # As the node's own name is: in the namespace of the launch.
    node = rosgraph.names.ns_join(rosgraph.names.get_ros_namespace(), sys.argv[1])
    topics = None
    while topics is None:
        topics = nodeTopics(node)
        time.sleep(POLL_SEC)
    # In place of this process, so that signals reach rosbag, which closes the bag on SIGINT. roslaunch appends
    # __name:= and __log:=, which are for rosbag.
    recorder = roslib.packages.find_node('rosbag', 'record')[0]
    os.execv(recorder, [recorder, '-O', bag] + COMMON + topics + sys.argv[2:])


if __name__ == '__main__':
    main()
