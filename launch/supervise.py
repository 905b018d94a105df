#!/usr/bin/env python3
"""roslaunch whose exit code is that of the required node that ended the run (roslaunch's own is always 0).

supervise.py PORT LAUNCH_FILE [ARG:=VALUE ...]     PORT of a master of its own, or - to use ROS_MASTER_URI

Interrupted: 130. A launch file that cannot be loaded: 1. A node that a signal ended: 128 + its number.
"""

import sys
import time

import rosgraph.names
import roslaunch
import roslaunch.config
import roslaunch.parent
from roslaunch.rlutil import get_or_generate_uuid


def fullName(node):
    return rosgraph.names.ns_join(node.namespace, node.name)


def nodeName(process_name):
    """Processes are called NODE-NUMBER, by the full name but for its first slash."""
    return '/' + process_name.rsplit('-', 1)[0]


def superviseRun(parent, required):
    """Ends with the first of the required nodes, and returns its exit code; None if interrupted."""
    parent.start()
    monitor = parent.pm
    exit_code = None
    while exit_code is None and not monitor.done:
        with monitor.plock:
            exit_codes = [process.exit_code for process in monitor.dead_list if nodeName(process.name) in required]
        exit_code = exit_codes[0] if exit_codes else None
        parent.spin_once()
        time.sleep(0.05)
    parent.shutdown()
    return exit_code


def main(port, launch_file, *arguments):
    port = None if port == '-' else int(port)
    run_id = get_or_generate_uuid(None, False)
    roslaunch.configure_logging(run_id)
    try:
        config = roslaunch.config.load_config_default([(launch_file, list(arguments))], port)
        required = {fullName(node) for node in config.nodes if node.required}
        # Ended by superviseRun(): roslaunch's own way announces a successful end in red.
        for node in config.nodes:
            node.required = False
        parent = roslaunch.parent.ROSLaunchParent(run_id, [launch_file], port=port, show_summary=False)
        parent.config = config
        exit_code = superviseRun(parent, required)
    except roslaunch.RLException as error:
        print(error, file=sys.stderr)
        return 1
    if exit_code is None:
        return 130
    return 128 - exit_code if exit_code < 0 else exit_code


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
