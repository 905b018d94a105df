#!/usr/bin/python3
"""Records a run: rosbag record with the topics of a node that is just starting.

record.py NODE FILE     NODE: name of the monolith_tank_node, FILE: the bag

rosbag's own way of finding topics looks once a second of ROS time, which stands still until the node starts.
"""

import os
import sys
import time

import rosgraph
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
    # roslaunch appends __name:= and __log:=, which are for rosbag.
    node, bag = '/' + sys.argv[1].strip('/'), sys.argv[2]
    topics = None
    while topics is None:
        topics = nodeTopics(node)
        time.sleep(POLL_SEC)
    # In place of this process, so that signals reach rosbag, which closes the bag on SIGINT.
    recorder = roslib.packages.find_node('rosbag', 'record')[0]
    os.execv(recorder, [recorder, '-O', bag] + COMMON + topics + sys.argv[3:])


if __name__ == '__main__':
    main()
