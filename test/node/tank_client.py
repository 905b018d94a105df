"""What the node tests share: waiting by wall time, and calls to the node's services. Not a test."""

import math
import threading
import time

import rospy
from geometry_msgs.msg import Point, Pose, Twist, Vector3, Wrench, WrenchStamped
from monolith_tank.msg import BodyStates
from monolith_tank.srv import (ApplyBodyWrench, ClearBodyWrenches, GetBodyState, SetBodyState, SetJointState,
                               StepPhysics)
from std_srvs.srv import Empty

NODE = '/monolith_tank'
TIMEOUT_SEC = 20.0


def waitUntil(condition, what, timeout_sec=TIMEOUT_SEC):
    """By wall time: simulated time may stand still."""
    end = time.time() + timeout_sec
    while not condition():
        if time.time() > end:
            raise AssertionError('waited %g s in vain for %s' % (timeout_sec, what))
        time.sleep(0.01)


class Collector:
    """All messages of a topic, in the order of their arrival."""

    def __init__(self, topic, message_type):
        self.messages = []
        self._lock = threading.Lock()
        self.subscriber = rospy.Subscriber(topic, message_type, self._receive, queue_size=1000)

    def _receive(self, message):
        with self._lock:
            self.messages.append(message)

    def clear(self):
        with self._lock:
            self.messages = []

    def count(self):
        return len(self.messages)

    def waitFor(self, count=1):
        waitUntil(lambda: self.count() >= count, '%d messages on %s' % (count, self.subscriber.name))
        return list(self.messages)


def service(name, service_type):
    rospy.wait_for_service(NODE + '/' + name, TIMEOUT_SEC)
    return rospy.ServiceProxy(NODE + '/' + name, service_type)


class Tank:
    """The node's services by their own names."""

    def __init__(self):
        self.pause = service('pause_physics', Empty)
        self.unpause = service('unpause_physics', Empty)
        self.reset = service('reset_simulation', Empty)
        self.stepService = service('step', StepPhysics)
        self.apply = service('apply_body_wrench', ApplyBodyWrench)
        self.clear = service('clear_body_wrenches', ClearBodyWrenches)
        self.get = service('get_body_state', GetBodyState)
        self.set = service('set_body_state', SetBodyState)
        self.setJoints = service('set_joint_state', SetJointState)

    def step(self, count=1):
        response = self.stepService(steps=count)
        assert response.success, response.message
        return response.time

    def state(self, body, frame=''):
        response = self.get(body_name=body, reference_frame=frame)
        assert response.success, response.status_message
        return response


def pose(x, y, z, orientation=(0.0, 0.0, 0.0, 1.0)):
    out = Pose()
    out.position = Point(x, y, z)
    out.orientation.x, out.orientation.y, out.orientation.z, out.orientation.w = orientation
    return out


def twist(linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0)):
    return Twist(Vector3(*linear), Vector3(*angular))


def wrench(force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)):
    return Wrench(Vector3(*force), Vector3(*torque))


def stamped(frame, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)):
    out = WrenchStamped()
    out.header.frame_id = frame
    out.wrench = wrench(force, torque)
    return out


def numbers(message):
    """Every number in a message, however deep."""
    if isinstance(message, (int, float)):
        return [float(message)]
    if isinstance(message, (list, tuple)):
        return [n for entry in message for n in numbers(entry)]
    if hasattr(message, '__slots__') and not isinstance(message, (rospy.Time, rospy.Duration)):
        return [n for slot in message.__slots__ for n in numbers(getattr(message, slot))]
    return []


def allFinite(message):
    return all(math.isfinite(n) for n in numbers(message))


__all__ = ['BodyStates', 'Collector', 'NODE', 'Tank', 'TIMEOUT_SEC', 'allFinite', 'numbers', 'pose', 'stamped', 'twist',
           'waitUntil', 'wrench']
