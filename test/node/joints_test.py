#!/usr/bin/python3
"""Robots of the running node: joint states, joint commands, set joints, frames, and every refusal. Lockstep."""

import math
import os
import sys
import unittest

import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from tank_client import NODE, BodyStates, Collector, Tank, allFinite, numbers, pose, stamped, waitUntil

NAN = float('nan')
GRAVITY = 9.81
JOINTS = ['shoulder', 'elbow', 'lift', 'wrist']
BODIES = ['crane', 'crane/upper', 'crane/fore', 'crane/rod', 'crane/hand']
TIMEOUT_STEPS = 5  # ~wrench_timeout


def yaw(rotation):
    """Angle about the vertical, of a quaternion that turns about nothing else."""
    return 2.0 * math.atan2(rotation.z, rotation.w)


class JointsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('joints_test')
        cls.tank = Tank()
        cls.diagnostics = Collector('/diagnostics', DiagnosticArray)
        cls.states = Collector(NODE + '/body_states', BodyStates)
        cls.commands = rospy.Publisher(NODE + '/crane/joint_commands', JointState, queue_size=10)
        waitUntil(lambda: cls.commands.get_num_connections() == 1, 'the node to listen to ' + cls.commands.name)

    def setUp(self):
        self.joints = Collector(NODE + '/crane/joint_states', JointState)
        self.addCleanup(self.joints.subscriber.unregister)
        self.tank.pause()
        self.tank.reset()

    # --- helpers ---

    def command(self, **fields):
        """Returns once the node has taken or refused the message."""
        self.commands.publish(JointState(**fields))
        rospy.rostime.wallsleep(0.2)

    def now(self):
        """Joint states as they are: {joint: (position, velocity, effort)}."""
        here = self.tank.state('crane').header.stamp
        waitUntil(lambda: self.joints.messages and self.joints.messages[-1].header.stamp == here, 'joint states of now')
        rospy.rostime.wallsleep(0.1)  # a state that was set has the stamp of the one before
        message = self.joints.messages[-1]
        return dict(zip(message.name, zip(message.position, message.velocity, message.effort)))

    def follow(self, steps, **fields):
        """Joint states after each of some steps from the start, with a command given before the first."""
        self.tank.reset()
        if fields:
            self.command(**fields)
        out = []
        for _ in range(steps):
            self.tank.step()
            out.append(self.now())
        return out

    def bodies(self):
        return [self.tank.state(body) for body in BODIES]

    def refusals(self):
        values = {}
        for array in list(self.diagnostics.messages):
            for status in array.status:
                if status.name.endswith('Commands'):
                    values = {value.key: value.value for value in status.values}
        return (int(values['Refused since the start']), values['Last refused']) if values else (0, '')

    # --- what is published ---

    def testTopicsAndTypes(self):
        types = dict(rosgraph.Master('/joints_test').getTopicTypes())
        for name in ('joint_states', 'joint_commands'):
            self.assertEqual(types.get(NODE + '/crane/' + name), 'sensor_msgs/JointState', name)
            self.assertNotIn(NODE + '/post/' + name, types)
            self.assertNotIn(NODE + '/crane/hand/' + name, types)
        for body in BODIES:
            self.assertEqual(types.get(NODE + '/' + body + '/odom'), 'nav_msgs/Odometry', body)
        for body in BODIES[1:]:
            self.assertEqual(types.get(NODE + '/' + body + '/wrench'), 'geometry_msgs/WrenchStamped', body)
        self.assertNotIn(NODE + '/crane/wrench', types, 'a fixed body takes no wrenches')

    def testJointStatesAreLatchedAndComeWithTheBodiesStates(self):
        # Without one that listens already, from whom another of the same process would have what came last.
        self.joints.subscriber.unregister()
        self.tank.step(3)
        rospy.rostime.wallsleep(0.3)
        self.joints = Collector(NODE + '/crane/joint_states', JointState)
        self.addCleanup(self.joints.subscriber.unregister)
        self.assertEqual(self.joints.waitFor()[0].header.stamp, self.tank.state('crane').header.stamp)
        rospy.rostime.wallsleep(0.3)
        self.joints.clear()
        self.states.clear()
        self.tank.step(20)
        rospy.rostime.wallsleep(0.3)
        self.assertEqual(self.joints.count(), 20)
        self.assertEqual([message.header.stamp for message in self.joints.messages],
                         [message.header.stamp for message in self.states.messages])
        for message in self.joints.messages:
            self.assertEqual(message.name, JOINTS)
            self.assertEqual([len(message.position), len(message.velocity), len(message.effort)], [4, 4, 4])
            self.assertTrue(allFinite(message))

    def testTheStartIsTheScenes(self):
        start = self.now()
        self.assertEqual([start[joint][0] for joint in JOINTS], [0.1, -0.2, 0.0, 0.0])
        self.assertAlmostEqual(start['elbow'][1], 0.2 * math.pi)
        self.assertEqual([start[joint][1] for joint in ('shoulder', 'lift', 'wrist')], [0.0, 0.0, 0.0])

    def testPositionsAreThoseOfTheFrames(self):
        tf = Collector('/tf', TFMessage)
        self.addCleanup(tf.subscriber.unregister)
        tf.waitFor()
        self.command(name=['wrist', 'shoulder', 'lift'], effort=[1e-5, 0.0, 0.0], position=[0.0, 0.6, 0.02])
        self.tank.step(15)
        joints = self.now()
        rospy.rostime.wallsleep(0.2)
        transforms = {t.child_frame_id: t for t in tf.messages[-1].transforms}
        self.assertEqual(set(transforms), {'left/post'} | {'left/' + body for body in BODIES})
        self.assertEqual({t.header.frame_id for t in transforms.values()}, {'world'})
        self.assertEqual(transforms['left/crane/upper'].header.stamp, self.joints.messages[-1].header.stamp)
        angle = 0.0
        for joint, body in (('shoulder', 'upper'), ('elbow', 'fore'), ('wrist', 'hand')):
            angle += joints[joint][0]
            self.assertAlmostEqual(yaw(transforms['left/crane/' + body].transform.rotation), angle, places=9)
        self.assertGreater(abs(joints['wrist'][0]), 1e-3)
        rod = transforms['left/crane/rod'].transform.translation
        self.assertAlmostEqual(rod.z, 0.15 + 0.02 + 0.02 + 0.02 + joints['lift'][0], places=9)
        shoulder, elbow = joints['shoulder'][0], joints['shoulder'][0] + joints['elbow'][0]
        self.assertAlmostEqual(rod.x, -0.1 + 0.12 * math.cos(shoulder) + 0.1 * math.cos(elbow), places=9)
        self.assertAlmostEqual(rod.y, 0.12 * math.sin(shoulder) + 0.1 * math.sin(elbow), places=9)
        # And velocities those of the bodies.
        spin = self.tank.state('crane/hand').twist.angular.z
        self.assertAlmostEqual(spin, sum(joints[joint][1] for joint in ('shoulder', 'elbow', 'wrist')), places=9)

    def testEffortIsWhatHoldsTheJoint(self):
        # The lift hangs on its servo, which gives way by its weight.
        self.tank.step(100)
        position, velocity, effort = self.now()['lift']
        weight = (0.016 + 0.024) * GRAVITY
        self.assertAlmostEqual(effort, weight, delta=1e-3 * weight)
        self.assertAlmostEqual(position, -weight / 400.0, delta=1e-3 * weight / 400.0)
        self.assertLess(abs(velocity), 1e-6)

    def testFrames(self):
        static = Collector('/tf_static', TFMessage)
        self.addCleanup(static.subscriber.unregister)
        links = {t.child_frame_id: t for t in static.waitFor()[-1].transforms}
        parents = {'left/crane/base': 'left/crane', 'left/crane/mount': 'left/crane',
                   'left/crane/tip': 'left/crane/hand', 'left/post/core': 'left/post', 'left/world/tank': 'world'}
        self.assertEqual({frame: t.header.frame_id for frame, t in links.items()}, parents)
        self.assertAlmostEqual(links['left/crane/tip'].transform.translation.x, 0.03)
        # In which states are given too.
        self.assertAlmostEqual(self.tank.state('crane/hand', 'left/crane/tip').pose.position.x, -0.03)
        self.assertAlmostEqual(self.tank.state('crane/hand', 'left/crane/hand').pose.position.x, 0.0)

    def testRobotDescriptionIsThereOnce(self):
        self.assertIn('name="crane"', rospy.get_param(NODE + '/crane/robot_description'))
        self.assertEqual(list(rospy.get_param(NODE + '/crane')), ['robot_description'])

    def testMarkersShowEachBodysOwnLinks(self):
        markers = Collector(NODE + '/markers', MarkerArray)
        self.addCleanup(markers.subscriber.unregister)
        shown = [marker.ns for marker in markers.waitFor()[-1].markers]
        self.assertEqual(sorted(shown), sorted(['post'] + BODIES))

    def testOdometryAndWrenchesOfABodyBeyondAJoint(self):
        odometry = Collector(NODE + '/crane/hand/odom', Odometry)
        self.addCleanup(odometry.subscriber.unregister)
        self.assertEqual(odometry.waitFor()[-1].child_frame_id, 'left/crane/hand')
        push = rospy.Publisher(NODE + '/crane/hand/wrench', WrenchStamped, queue_size=1)
        waitUntil(lambda: push.get_num_connections() == 1, 'the node to listen to ' + push.name)
        without = self.follow(3)[-1]['wrist'][0]
        self.tank.reset()
        push.publish(stamped('left/crane/hand', torque=(0.0, 0.0, 1e-4)))
        rospy.rostime.wallsleep(0.2)
        self.tank.step(3)
        self.assertGreater(self.now()['wrist'][0], without + 1e-3)

    # --- commands ---

    def testEffortAcceleratesUntilItsTimeIsOver(self):
        without = [state['wrist'][1] for state in self.follow(10)]
        for sign in (1.0, -1.0):
            pushed = self.follow(10, name=['wrist'], effort=[sign * 2e-5])
            gain = [sign * (state['wrist'][1] - velocity) for state, velocity in zip(pushed, without)]
            self.assertEqual([round(sign * state['wrist'][2] / 2e-5, 6) for state in pushed],
                             [1.0] * TIMEOUT_STEPS + [0.0] * 5)
            steps = [after - before for before, after in zip([0.0] + gain, gain)]
            self.assertGreater(min(steps[:TIMEOUT_STEPS]), 1e-2)
            # The hand's own inertia, as seen from a crane that gives way a little.
            self.assertAlmostEqual(gain[TIMEOUT_STEPS - 1], 2e-5 / 1e-5 * 0.1, delta=0.02)
            self.assertLess(max(abs(step) for step in steps[TIMEOUT_STEPS:]), 0.1 * min(steps[:TIMEOUT_STEPS]))

    def testALaterEffortReplacesTheFirst(self):
        self.tank.reset()
        self.command(name=['wrist'], effort=[2e-5])
        self.tank.step(3)
        self.command(name=['wrist'], effort=[-1e-5])
        efforts = []
        for _ in range(TIMEOUT_STEPS + 2):
            self.tank.step()
            efforts.append(round(self.now()['wrist'][2] / 1e-5, 6))
        self.assertEqual(efforts, [-1.0] * TIMEOUT_STEPS + [0.0] * 2)

    def testPositionBringsAServoThereAndStays(self):
        self.command(name=['lift', 'shoulder'], position=[0.03, 0.7])
        self.tank.step(100)
        state = self.now()
        # But for what the elbow's swing and the weight on the lift take.
        self.assertAlmostEqual(state['shoulder'][0], 0.7, delta=2e-3)
        self.assertAlmostEqual(state['lift'][0], 0.03 - 0.04 * GRAVITY / 400.0, delta=1e-5)
        # What is not given stays: another joint, and another part of the command.
        self.command(name=['shoulder'], position=[-0.4])
        self.command(name=['lift'], effort=[0.04 * GRAVITY])
        self.tank.step(TIMEOUT_STEPS)
        self.assertGreater(self.now()['lift'][0], 0.0295)
        self.tank.step(100)
        state = self.now()
        self.assertAlmostEqual(state['shoulder'][0], -0.4, delta=2e-3)
        self.assertAlmostEqual(state['lift'][0], 0.03 - 0.04 * GRAVITY / 400.0, delta=1e-5)

    def testVelocityIsHeldUntilItsTimeIsOver(self):
        positions = [state['shoulder'][0] for state in self.follow(60, name=['shoulder'], velocity=[1.0])]
        # Against its stiffness; then back.
        self.assertGreater(positions[TIMEOUT_STEPS - 1], 0.12)
        self.assertEqual(max(positions), max(positions[:TIMEOUT_STEPS + 2]))
        self.assertAlmostEqual(positions[-1], 0.1, delta=2e-3)

    def testResetForgetsCommandsAndRepeatsTheRun(self):
        self.tank.step(5)
        first = self.bodies()
        self.tank.reset()
        self.command(name=['shoulder', 'wrist'], position=[0.5, 0.0], effort=[0.0, 1e-4], velocity=[1.0, 0.0])
        self.tank.step()
        self.tank.reset()
        self.tank.step(5)
        self.assertEqual(self.bodies(), first)

    def testBadCommandsAreRefusedWhole(self):
        topic = NODE + '/crane/joint_commands: '
        cases = [
            (dict(name=['wrist', 'sholder'], effort=[1.0, 1.0]),
             topic + 'name[1]: value "sholder": expected a movable joint of "crane", the nearest is "shoulder"'),
            (dict(name=['mount_joint'], position=[0.0]), 'name[0]: value "mount_joint": expected a movable joint'),
            (dict(name=['wrist', 'elbow'], effort=[1.0, 1.0]),
             'name[1]: value "elbow": this joint moves as the scene prescribes'),
            (dict(name=['wrist', 'lift', 'wrist'], effort=[1.0, 1.0, 1.0]), 'name[2]: value "wrist": named before'),
            (dict(name=['wrist', 'lift'], effort=[1.0, 1.0], position=[0.0]),
             'position: 1 values: expected 2, one for each name'),
            (dict(name=['wrist'], velocity=[0.0, 1.0], effort=[1.0]), 'velocity: 2 values: expected 1'),
            (dict(name=['wrist'], effort=[1.0, 1.0, 1.0]), 'effort: 3 values: expected 1'),
            (dict(name=['wrist', 'lift'], effort=[1.0, NAN]),
             'effort[1]: value nan for "lift": expected a finite number'),
            (dict(name=['wrist'], position=[float('inf')], effort=[1.0]), 'position[0]: value inf for "wrist"'),
            (dict(name=['wrist'], velocity=[-float('inf')], effort=[1.0]), 'velocity[0]: value -inf for "wrist"'),
            (dict(name=['wrist']), 'position, velocity, effort: no values'),
            (dict(), 'name: value []: expected names of joints of "crane"'),
            (dict(effort=[1.0]), 'name: value []')]
        self.tank.step(3)
        undisturbed = self.bodies()
        self.tank.reset()
        for fields, text in cases:
            refused = self.refusals()[0]
            self.commands.publish(JointState(**fields))
            waitUntil(lambda: self.refusals()[0] == refused + 1, 'the refusal on /diagnostics: ' + text)
            self.assertTrue(self.refusals()[1].startswith(topic), self.refusals()[1])
            self.assertIn(text, self.refusals()[1])
        self.tank.step(3)
        self.assertEqual(self.bodies(), undisturbed)

    # --- states that are set ---

    def testSetJoints(self):
        self.tank.step(2)
        before = self.now()
        response = self.tank.setJoints(body='crane', names=['lift', 'shoulder'], positions=[0.01, -0.5],
                                       velocities=[0.2, -1.0])
        self.assertTrue(response.success, response.status_message)
        after = self.now()
        self.assertEqual(after['lift'][:2], (0.01, 0.2))
        self.assertEqual(after['shoulder'][:2], (-0.5, -1.0))
        for joint in ('elbow', 'wrist'):
            self.assertEqual(after[joint], before[joint])
        self.assertAlmostEqual(yaw(self.tank.state('crane/upper').pose.orientation), -0.5, places=9)
        # Its velocity is optional; the servo brings it back.
        response = self.tank.setJoints(body='crane', names=['shoulder'], positions=[0.4])
        self.assertTrue(response.success, response.status_message)
        self.assertEqual(self.now()['shoulder'][:2], (0.4, 0.0))
        self.tank.step(100)
        self.assertAlmostEqual(self.now()['shoulder'][0], 0.1, delta=2e-3)

    def testBadJointStatesAreRefusedAndNoneIsSet(self):
        cases = [(dict(body='cran', names=['lift'], positions=[0.0]),
                  ['body: value "cran": expected a robot', 'the nearest is "crane"']),
                 (dict(body='post', names=['lift'], positions=[0.0]), ['body: value "post": expected a robot']),
                 (dict(body='crane/hand', names=['wrist'], positions=[0.0]), ['body: value "crane/hand"']),
                 (dict(body='crane'), ['names: value []']),
                 (dict(body='crane', names=['lift', 'wirst'], positions=[0.01, 0.0]),
                  ['names[1]: value "wirst"', '"wrist"']),
                 (dict(body='crane', names=['lift', 'elbow'], positions=[0.01, 0.0]),
                  ['names[1]: value "elbow"', 'prescribes']),
                 (dict(body='crane', names=['lift', 'lift'], positions=[0.01, 0.0]), ['names[1]', 'named before']),
                 (dict(body='crane', names=['lift', 'wrist'], positions=[0.01]), ['positions: 1 values: expected 2']),
                 (dict(body='crane', names=['lift']), ['positions: 0 values: expected 1']),
                 (dict(body='crane', names=['lift', 'wrist'], positions=[0.01, NAN]),
                  ['positions[1]: value nan for "wrist"']),
                 (dict(body='crane', names=['lift'], positions=[0.01], velocities=[1.0, 2.0]),
                  ['velocities: 2 values: expected 1']),
                 (dict(body='crane', names=['lift'], positions=[0.01], velocities=[float('inf')]),
                  ['velocities[0]: value inf for "lift"']),
                 (dict(body='crane', names=['lift', 'shoulder'], positions=[0.01, 1.6]),
                  ['positions[1]: value 1.6 for "shoulder"', 'from -1.5 to 1.5']),
                 # Where the post is.
                 (dict(body='crane', names=['shoulder'], positions=[1.2]), ['crane/upper', 'post'])]
        self.tank.step(5)
        undisturbed = self.bodies()
        self.tank.reset()
        self.tank.step(2)
        before, bodies = self.now(), self.bodies()
        for request, words in cases:
            response = self.tank.setJoints(**request)
            self.assertFalse(response.success, str(request))
            for word in words:
                self.assertIn(word, response.status_message)
            self.assertEqual(self.bodies(), bodies)
            self.assertEqual(self.now(), before)
        self.tank.step(3)
        self.assertEqual(self.bodies(), undisturbed)

    def testNoneIsSetIfOneIsRefused(self):
        self.tank.step(2)
        before, bodies = self.now(), self.bodies()
        response = self.tank.setJoints(body='crane', names=['lift', 'wrist', 'shoulder'], positions=[0.01, 0.5, 1.2],
                                       velocities=[0.1, 0.1, 0.0])
        self.assertFalse(response.success)
        for word in ('crane/upper', 'post'):
            self.assertIn(word, response.status_message)
        self.assertEqual(self.now(), before)
        self.assertEqual(self.bodies(), bodies)

    def testABodyBeyondAJointCannotBeSet(self):
        before = self.bodies()
        response = self.tank.set(body_name='crane/hand', pose=pose(0.0, 0.0, 0.1))
        self.assertFalse(response.success)
        for word in ('crane/hand', "hangs on 'crane'"):
            self.assertIn(word, response.status_message)
        response = self.tank.set(body_name='crane', pose=pose(0.0, 0.0, 0.1))
        self.assertFalse(response.success)
        self.assertIn('fixed', response.status_message)
        self.assertEqual(self.bodies(), before)


if __name__ == '__main__':
    rostest.rosrun('monolith_tank', 'joints', JointsTest)
