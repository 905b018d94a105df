#!/usr/bin/python3
"""Topics, clock, frames, rates and services of the running node, and every refusal. Lockstep: the test grants steps."""

import math
import os
import struct
import sys
import time
import unittest

import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, TransformStamped, WrenchStamped
from monolith_tank.msg import Statistics
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from tank_client import (NODE, BodyStates, Collector, Tank, allFinite, pose, stamped, twist, waitUntil, wrench)

STEP_SEC = 0.02
NAN = float('nan')
HUGE = 1.79e308
# What shows where the simulation stands. All of it latched.
STATE_TOPICS = [('/tf', TFMessage), (NODE + '/body_states', BodyStates), (NODE + '/ball/odom', Odometry),
                (NODE + '/probe/odom', Odometry), (NODE + '/surface', PointCloud2), (NODE + '/statistics', Statistics),
                (NODE + '/markers', MarkerArray)]


def stampOf(message):
    """Of its first part, where a message has no header of its own."""
    if isinstance(message, TFMessage):
        return message.transforms[0].header.stamp
    if isinstance(message, MarkerArray):
        return message.markers[0].header.stamp
    return message.header.stamp


class Listener:
    """What tf2_ros::TransformListener holds, of which there is no Python here: the latest transform of each frame by
    stamp, the first of those with the same one, all forgotten by the first message after time has jumped back."""

    def __init__(self):
        self.latest = {}
        self._last_update = rospy.Time()
        self.subscriber = rospy.Subscriber('/tf', TFMessage, self._receive, queue_size=100)

    def _receive(self, message):
        now = rospy.Time.now()
        if now < self._last_update:
            self.latest.clear()
        self._last_update = now
        for transform in message.transforms:
            held = self.latest.get(transform.child_frame_id)
            if held is None or transform.header.stamp > held.header.stamp:
                self.latest[transform.child_frame_id] = transform


class InterfaceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('interface_test')
        cls.tank = Tank()
        cls.diagnostics = Collector('/diagnostics', DiagnosticArray)
        cls.ball_wrench = rospy.Publisher(NODE + '/ball/wrench', WrenchStamped, queue_size=10)
        cls.probe_wrench = rospy.Publisher(NODE + '/probe/wrench', WrenchStamped, queue_size=10)
        cls.static_frames = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        for publisher in (cls.ball_wrench, cls.probe_wrench):
            waitUntil(lambda: publisher.get_num_connections() == 1, 'the node to listen to ' + publisher.name)

    def setUp(self):
        self.tank.pause()
        self.tank.reset()

    # --- helpers ---

    def send(self, publisher, message):
        """Returns once the node has taken or refused the message."""
        publisher.publish(message)
        rospy.rostime.wallsleep(0.2)

    def refusals(self):
        values = {}
        for array in list(self.diagnostics.messages):
            for status in array.status:
                if status.name.endswith('Commands'):
                    values = {value.key: value.value for value in status.values}
                    level = status.level
        return (int(values['Refused since the start']), level) if values else (0, 0)

    def unchanged(self, body, before):
        after = self.tank.state(body)
        self.assertEqual(before.pose, after.pose)
        self.assertEqual(before.twist, after.twist)

    def drift(self, body, act, steps=5):
        """How far `act` moves the body in some steps, against the same run without it."""
        self.tank.reset()
        self.tank.step(steps)
        without = self.tank.state(body).pose
        self.tank.reset()
        act()
        self.tank.step(steps)
        with_it = self.tank.state(body).pose
        turn = 2.0 * with_it.orientation.z - 2.0 * without.orientation.z
        return (with_it.position.x - without.position.x, with_it.position.y - without.position.y,
                with_it.position.z - without.position.z, turn)

    def fastestStep(self, body, steps):
        """Number of the step, from 1, after which the body's speed along x is largest; it must rise and fall once."""
        speeds = []
        for _ in range(steps):
            self.tank.step()
            speeds.append(self.tank.state(body).twist.linear.x)
        fastest = speeds.index(max(speeds))
        self.assertEqual(speeds[:fastest + 1], sorted(speeds[:fastest + 1]))
        self.assertEqual(speeds[fastest:], sorted(speeds[fastest:], reverse=True))
        return fastest + 1

    def stateCollectors(self):
        """Gone with the test: whoever subscribes while another does gets what that one had last, and maybe late."""
        collectors = {topic: Collector(topic, kind) for topic, kind in STATE_TOPICS}
        for collector in collectors.values():
            self.addCleanup(collector.subscriber.unregister)
        return collectors

    # --- topics ---

    def testTopicsAndTypes(self):
        types = dict(rosgraph.Master('/interface_test').getTopicTypes())
        expected = {'/clock': 'rosgraph_msgs/Clock', '/tf': 'tf2_msgs/TFMessage', '/tf_static': 'tf2_msgs/TFMessage',
                    '/diagnostics': 'diagnostic_msgs/DiagnosticArray'}
        own = {'body_states': 'monolith_tank/BodyStates', 'surface': 'sensor_msgs/PointCloud2',
               'statistics': 'monolith_tank/Statistics', 'markers': 'visualization_msgs/MarkerArray',
               'tank': 'visualization_msgs/MarkerArray', 'ball/odom': 'nav_msgs/Odometry',
               'probe/odom': 'nav_msgs/Odometry', 'post/odom': 'nav_msgs/Odometry',
               'ball/wrench': 'geometry_msgs/WrenchStamped', 'probe/wrench': 'geometry_msgs/WrenchStamped'}
        expected.update({NODE + '/' + name: kind for name, kind in own.items()})
        for topic, kind in expected.items():
            self.assertEqual(types.get(topic), kind, topic)
        self.assertNotIn(NODE + '/post/wrench', types, 'a fixed body takes no wrenches')

    def testRatesAndClock(self):
        collectors = {name: Collector(topic, kind) for name, topic, kind in [
            ('clock', '/clock', Clock), ('tf', '/tf', TFMessage), ('states', NODE + '/body_states', BodyStates),
            ('odom', NODE + '/ball/odom', Odometry), ('surface', NODE + '/surface', PointCloud2),
            ('statistics', NODE + '/statistics', Statistics), ('markers', NODE + '/markers', MarkerArray)]}
        waitUntil(lambda: all(c.subscriber.get_num_connections() for c in collectors.values()), 'connections')
        rospy.rostime.wallsleep(0.3)  # what is latched
        for collector in collectors.values():
            collector.clear()
        begin = time.monotonic()
        self.tank.step(50)  # 1 s
        taken = time.monotonic() - begin
        rospy.rostime.wallsleep(0.5)
        expected = {'tf': 25, 'states': 25, 'odom': 25, 'surface': 10, 'statistics': 10, 'markers': 25}
        for name, count in expected.items():
            self.assertEqual(collectors[name].count(), count, name)
        clock = [message.clock.to_sec() for message in collectors['clock'].messages]
        self.assertEqual(clock, sorted(clock))
        # Repeated while time stands still, and rospy itself may skip some; each is the time of a step.
        for stamp in clock:
            self.assertAlmostEqual(stamp, round(stamp / STEP_SEC) * STEP_SEC, places=6)
        self.assertAlmostEqual(clock[-1], 51 * STEP_SEC, places=6)
        self.assertGreater(clock[0], 0.0)
        for name in ('states', 'odom', 'surface', 'statistics'):
            stamps = [message.header.stamp for message in collectors[name].messages]
            self.assertEqual(stamps, sorted(set(stamps)), name)
            self.assertTrue(all(message.header.frame_id == 'world' for message in collectors[name].messages), name)
            self.assertTrue(all(allFinite(message) for message in collectors[name].messages), name)
        last = collectors['statistics'].messages[-1]
        self.assertEqual(last.step, 50)
        self.assertAlmostEqual(last.time, 1.0)
        self.assertTrue(last.committed)
        self.assertTrue(last.liquid and last.viscosity and last.free_surface)
        self.assertGreater(last.total_time, 0.0)
        publishing = [message.publishing_time for message in collectors['statistics'].messages]
        self.assertGreater(min(publishing), 0.0)
        self.assertLess(sum(publishing) + last.total_time, taken)
        volume = 0.16 * 0.16 * 0.08
        self.assertGreater(last.liquid_volume, 0.8 * volume)
        self.assertLess(last.liquid_volume, volume)

    def testFramesAndStates(self):
        tf, states = Collector('/tf', TFMessage), Collector(NODE + '/body_states', BodyStates)
        odometry = Collector(NODE + '/probe/odom', Odometry)
        static = Collector('/tf_static', TFMessage)
        waitUntil(lambda: tf.subscriber.get_num_connections() and odometry.subscriber.get_num_connections(), 'topics')
        states.waitFor()
        half = math.sqrt(0.5)
        response = self.tank.set(body_name='probe', pose=pose(0.04, 0.03, 0.06, (0.0, 0.0, half, half)),
                                 twist=twist((0.1, 0.02, 0.0), (0.0, 0.0, 1.0)))
        self.assertTrue(response.success, response.status_message)
        rospy.rostime.wallsleep(0.3)
        state = states.messages[-1]
        self.assertEqual(state.names, ['ball', 'probe', 'post'])
        self.assertEqual(len(state.liquid_wrenches), 3)
        self.assertEqual(len(state.contact_wrenches), 3)
        self.assertAlmostEqual(state.poses[1].position.y, 0.03)
        self.assertAlmostEqual(state.twists[1].linear.x, 0.1)
        # Odometry has its twist in the body's axes: x of the world is -y of a body turned by 90 degrees.
        own = odometry.messages[-1]
        self.assertEqual(own.child_frame_id, 'probe')
        self.assertAlmostEqual(own.twist.twist.linear.x, 0.02)
        self.assertAlmostEqual(own.twist.twist.linear.y, -0.1)
        self.assertAlmostEqual(own.twist.twist.angular.z, 1.0)
        self.tank.step(2)
        rospy.rostime.wallsleep(0.3)
        transform = {t.child_frame_id: t for t in tf.messages[-1].transforms}
        self.assertEqual(set(transform), {'ball', 'probe', 'post'})
        state = states.messages[-1]
        self.assertEqual(transform['probe'].header.stamp, state.header.stamp)
        self.assertEqual(transform['probe'].header.frame_id, 'world')
        self.assertEqual(transform['probe'].transform.rotation, state.poses[1].orientation)
        for axis in 'xyz':
            self.assertEqual(getattr(transform['probe'].transform.translation, axis),
                             getattr(state.poses[1].position, axis))
        links = {t.child_frame_id: t for message in static.messages for t in message.transforms}
        self.assertEqual(links['probe/tip'].header.frame_id, 'probe')
        self.assertAlmostEqual(links['probe/tip'].transform.translation.z, 0.02)
        self.assertEqual(links['world/tank'].header.frame_id, 'world')
        self.assertAlmostEqual(links['world/tank'].transform.translation.x, -0.08)
        self.assertEqual(links['ball/core'].header.frame_id, 'ball')

    def testALateSubscriberSeesWhereThePausedSimulationStands(self):
        self.tank.step(3)  # the states are due after steps 2 and 4, the surface and the statistics after 5
        here = self.tank.state('ball')
        rospy.rostime.wallsleep(0.3)
        last = {topic: collector.waitFor()[-1] for topic, collector in self.stateCollectors().items()}
        for topic, message in last.items():
            self.assertEqual(stampOf(message), here.header.stamp, topic)
        transforms = {transform.child_frame_id: transform for transform in last['/tf'].transforms}
        self.assertEqual(set(transforms), {'ball', 'probe', 'post'})
        self.assertEqual(transforms['ball'].transform.translation.z, here.pose.position.z)

    def testEveryTopicStopsWithTheSimulationAndRepeatsNothing(self):
        collectors = self.stateCollectors()
        waitUntil(lambda: all(c.subscriber.get_num_connections() for c in collectors.values()), 'connections')

        def stampsAfter(act):
            rospy.rostime.wallsleep(0.3)  # what is latched, and what is still on its way
            for collector in collectors.values():
                collector.clear()
            act()
            rospy.rostime.wallsleep(0.3)
            stamps = {topic: [stampOf(message) for message in collector.messages]
                      for topic, collector in collectors.items()}
            for topic, times in stamps.items():
                self.assertEqual(times, sorted(set(times)), topic)
            return stamps

        def run():
            self.tank.unpause()
            begin = self.tank.state('ball').header.stamp
            waitUntil(lambda: self.tank.state('ball').header.stamp > begin, 'simulated time to go on')
            self.tank.pause()

        # One step, after which nothing is due; four more, after which all but the states are; runs that stop anywhere.
        for act in (self.tank.step, lambda: self.tank.step(4), run, run):
            stamps = stampsAfter(act)
            here = self.tank.state('ball').header.stamp
            for topic, times in stamps.items():
                self.assertTrue(times, topic)
                self.assertEqual(times[-1], here, topic)
            # Once more, there is nothing new to say.
            self.assertFalse(any(stampsAfter(self.tank.pause).values()))

    def testAStepThatFailsIsReportedOnce(self):
        collectors = self.stateCollectors()
        statistics = collectors[NODE + '/statistics']
        statistics.waitFor()
        self.tank.apply(body_name='ball', wrench=wrench((1e305, 0.0, 0.0)),
                        start_time=rospy.Time.from_sec(4 * STEP_SEC), duration=rospy.Duration.from_sec(-1.0))
        rospy.rostime.wallsleep(0.3)  # what is latched, and what is still on its way
        statistics.clear()
        # After the third step, of which there are no statistics by their rate.
        self.assertFalse(self.tank.stepService(steps=10).success)
        rospy.rostime.wallsleep(0.3)
        self.assertEqual([(message.step, message.committed) for message in statistics.messages], [(3, False)])
        here = self.tank.state('ball').header.stamp
        for topic, collector in collectors.items():
            self.assertEqual(stampOf(collector.messages[-1]), here, topic)

    def testAListenerForgetsTheOldRunWithAReset(self):
        listener = Listener()
        self.addCleanup(listener.subscriber.unregister)
        initial = rospy.Time.from_sec(STEP_SEC)
        self.tank.set(body_name='ball', pose=pose(-0.04, 0.0, 0.05), twist=twist((0.5, 0.0, 0.0)))
        # More than once: without the delay it depends on which of two connections is the quicker one.
        for _ in range(5):
            # It goes by the time on /clock, which comes to it late.
            begin = self.tank.step(4)
            waitUntil(lambda: rospy.Time.now() == begin, 'the time')
            end = self.tank.step()
            waitUntil(lambda: listener.latest['ball'].header.stamp == end, 'the last pose')
            self.tank.reset()
            waitUntil(lambda: listener.latest['ball'].header.stamp == initial, 'the initial pose', 2.0)
            self.assertEqual(listener.latest['ball'].transform.translation.x, -0.04)

    def testStatisticsBeforeTheFirstStepAreOfTheState(self):
        statistics = Collector(NODE + '/statistics', Statistics)
        statistics.waitFor()
        rospy.rostime.wallsleep(0.3)  # what is latched, and what is still on its way
        statistics.clear()
        self.tank.reset()
        initial = statistics.waitFor()[-1]
        self.assertEqual((initial.status, initial.committed, initial.step), ('not run', False, 0))
        self.assertTrue(initial.liquid and initial.viscosity and initial.free_surface)
        self.assertAlmostEqual(initial.liquid_volume, 0.16 * 0.16 * 0.08, delta=0.1 * 0.16 * 0.16 * 0.08)
        self.assertEqual(initial.kinetic_energy, 0.0)
        # That of the liquid alone, about, whose bodies are as heavy as it is.
        self.assertAlmostEqual(initial.potential_energy, 900.0 * 0.16 * 0.16 * 0.08 * 9.81 * 0.04, delta=0.1)
        self.tank.set(body_name='ball', pose=pose(-0.04, 0.0, 0.05), twist=twist((2.0, 0.0, 0.0)))
        waitUntil(lambda: statistics.messages[-1].kinetic_energy > 0.0, 'the energy of the state that was set')
        self.assertAlmostEqual(statistics.messages[-1].kinetic_energy, 0.5 * 0.030159289 * 4.0, places=9)

    def testSurfaceIsTheFillLevel(self):
        cloud = Collector(NODE + '/surface', PointCloud2).waitFor()[-1]
        self.assertEqual([field.name for field in cloud.fields],
                         ['x', 'y', 'z', 'normal_x', 'normal_y', 'normal_z', 'vx', 'vy', 'vz'])
        self.assertEqual(len(cloud.data), cloud.width * cloud.point_step)
        self.assertGreater(cloud.width, 40)
        # A quarter of a cell for what the bodies displace.
        heights = [struct.unpack_from('<f', cloud.data, i * cloud.point_step + 8)[0] for i in range(cloud.width)]
        self.assertLess(max(abs(z - 0.08) for z in heights), 0.005)

    def testMarkersShowEveryBody(self):
        markers = Collector(NODE + '/markers', MarkerArray).waitFor()[-1].markers
        self.assertEqual({marker.ns for marker in markers}, {'ball', 'probe', 'post'})
        probe = [marker for marker in markers if marker.ns == 'probe'][0]
        self.assertEqual(probe.type, probe.CUBE)
        self.assertAlmostEqual(probe.scale.x, 0.03)
        self.assertAlmostEqual(probe.color.r, 0.8, places=5)
        self.assertAlmostEqual(probe.pose.position.y, 0.04)
        self.assertGreater(len(Collector(NODE + '/tank', MarkerArray).waitFor()[-1].markers), 1)

    def testRobotDescriptions(self):
        for body in ('ball', 'probe', 'post'):
            self.assertIn('<robot', rospy.get_param(NODE + '/' + body + '/robot_description'))

    # --- time ---

    def testStepping(self):
        start = rospy.Time.from_sec(STEP_SEC)
        self.assertEqual(self.tank.step(1), start + rospy.Duration.from_sec(STEP_SEC))
        self.assertEqual(self.tank.step(3), start + rospy.Duration.from_sec(4 * STEP_SEC))
        self.tank.reset()
        self.assertEqual(self.tank.state('ball').header.stamp, start)

    def testPauseAndUnpause(self):
        self.tank.unpause()
        begin = self.tank.state('ball').header.stamp
        waitUntil(lambda: self.tank.state('ball').header.stamp > begin, 'simulated time to go on')
        refused = self.tank.stepService(steps=1)
        self.assertFalse(refused.success)
        self.assertIn('pause_physics', refused.message)
        self.tank.pause()
        paused = self.tank.state('ball').header.stamp
        rospy.rostime.wallsleep(0.3)
        self.assertEqual(self.tank.state('ball').header.stamp, paused)

    def testStepRefusesTooFewAndTooMany(self):
        before = self.tank.state('ball')
        for steps in (0, 100001, 4294967295):
            response = self.tank.stepService(steps=steps)
            self.assertFalse(response.success)
            self.assertIn(str(steps), response.message)
            self.assertIn('1 to 100000', response.message)
        self.unchanged('ball', before)

    def testResetRepeatsTheRunExactly(self):
        self.tank.step(5)
        first = self.tank.state('ball')
        self.tank.reset()
        self.tank.step(5)
        self.unchanged('ball', first)

    # --- wrenches by topic ---

    def testWrenchPushesInItsDirectionAndTimesOut(self):
        push = stamped('world', force=(0.02, 0.0, 0.0))
        x, y, _, _ = self.drift('ball', lambda: self.send(self.ball_wrench, push))
        self.assertGreater(x, 1e-4)
        self.assertLess(abs(y), 0.2 * x)
        # Held for 0.1 s, which is 5 steps: it is fastest after them.
        self.tank.reset()
        self.send(self.ball_wrench, push)
        self.assertEqual(self.fastestStep('ball', 10), 5)

    def testLaterWrenchReplacesTheFirst(self):
        def act():
            self.send(self.ball_wrench, stamped('world', force=(0.02, 0.0, 0.0)))
            self.send(self.ball_wrench, stamped('world', force=(0.0, 0.02, 0.0)))
        x, y, _, _ = self.drift('ball', act)
        self.assertGreater(y, 1e-4)
        self.assertLess(abs(x), 0.2 * y)

    def testWrenchInTheBodysOwnFrame(self):
        # The probe is turned by 90 degrees about z: its x axis is the world's y.
        push = stamped('probe', force=(0.1, 0.0, 0.0))
        x, y, _, turn = self.drift('probe', lambda: self.send(self.probe_wrench, push))
        self.assertGreater(y, 5e-5)
        self.assertLess(abs(x), 0.2 * y)
        # The body slides past a wall; had the force acted elsewhere it would turn by more than a degree.
        self.assertLess(abs(turn), 0.02)

    def testWrenchOfAnotherBodysFrameActsAtItsOrigin(self):
        # From the ball's origin, at negative x of the probe, a force along y is a negative torque about the probe's z.
        # Small: it is not to turn by more than a quarter.
        push = stamped('ball', force=(0.0, 0.01, 0.0))
        _, y, _, turn = self.drift('probe', lambda: self.send(self.probe_wrench, push))
        self.assertGreater(y, 5e-5)
        self.assertLess(turn, -0.02)

    def testWrenchInALinkFrame(self):
        # At the tip, above the centre of mass, a force along the probe's x tilts it.
        self.send(self.probe_wrench, stamped('probe/tip', force=(0.05, 0.0, 0.0)))
        self.tank.step(3)
        tilted = self.tank.state('probe', 'probe').twist.angular.y
        self.assertGreater(tilted, 0.01)

    def testWrenchInAForeignFrame(self):
        # Somebody else's frame, 0.03 m beside the probe's centre along the probe's x and turned to the world's axes.
        transform = TransformStamped()
        transform.header.frame_id = 'probe'
        transform.child_frame_id = 'thruster'
        transform.transform.translation.x = 0.03
        transform.transform.rotation.z = -math.sqrt(0.5)
        transform.transform.rotation.w = math.sqrt(0.5)
        self.static_frames.publish(TFMessage([transform]))
        waitUntil(lambda: self.tank.get(body_name='probe', reference_frame='thruster').success, 'the foreign frame')
        in_frame = self.tank.state('probe', 'thruster').pose
        self.assertAlmostEqual(in_frame.position.y, -0.03)
        push = stamped('thruster', force=(0.1, 0.0, 0.0))
        x, _, _, turn = self.drift('probe', lambda: self.send(self.probe_wrench, push))
        self.assertGreater(x, 5e-5)
        self.assertLess(turn, -0.02)

    def testBadWrenchesAreRefusedAndCounted(self):
        before = self.tank.state('ball')
        refused, _ = self.refusals()
        for message in (stamped('world', force=(NAN, 0.0, 0.0)), stamped('world', torque=(0.0, float('inf'), 0.0)),
                        stamped('wrld', force=(1.0, 0.0, 0.0)), stamped('', force=(1.0, 0.0, 0.0)),
                        # Too large for a number only where they are added up, about the centre of mass.
                        stamped('probe', force=(HUGE, 0.0, 0.0), torque=(0.0, 0.0, HUGE))):
            self.send(self.ball_wrench, message)
        waitUntil(lambda: self.refusals()[0] == refused + 5, 'the refusals on /diagnostics')
        level = self.refusals()[1]
        self.assertEqual(level if isinstance(level, int) else ord(level), 1)
        self.unchanged('ball', before)
        x, y, z, turn = self.drift('ball', lambda: self.send(self.ball_wrench, stamped('wrld', force=(1.0, 0.0, 0.0))))
        self.assertEqual((x, y, z, turn), (0.0, 0.0, 0.0, 0.0))

    # --- wrenches by service ---

    def testAppliedWrenchStartsAndEnds(self):
        # Acts in the 4th and 5th step: the initial state has the stamp of one step.
        self.assertTrue(self.tank.apply(body_name='ball', wrench=wrench((0.02, 0.0, 0.0)),
                                        start_time=rospy.Time.from_sec(4 * STEP_SEC),
                                        duration=rospy.Duration.from_sec(2 * STEP_SEC)).success)
        self.tank.step(3)
        self.assertLess(abs(self.tank.state('ball').twist.linear.x), 1e-3)
        self.assertEqual(self.fastestStep('ball', 5), 2)

    def testWrenchWithoutEndActsUntilCleared(self):
        self.tank.apply(body_name='ball', reference_frame='ball', wrench=wrench((0.02, 0.0, 0.0)),
                        duration=rospy.Duration.from_sec(-1.0))
        self.assertEqual(self.fastestStep('ball', 8), 8)
        self.assertTrue(self.tank.clear(body_name='ball').success)
        self.assertEqual(self.fastestStep('ball', 3), 1)

    def testAppliedWrenchesAddUp(self):
        for direction in (1.0, -1.0):
            self.tank.apply(body_name='ball', wrench=wrench((direction * 0.2, 0.0, 0.0)),
                            duration=rospy.Duration.from_sec(1.0))
        self.tank.step(5)
        balanced = self.tank.state('ball')
        self.tank.reset()
        self.tank.step(5)
        self.unchanged('ball', balanced)

    def testReferencePointGivesATorque(self):
        self.tank.apply(body_name='probe', reference_frame='probe', reference_point=Point(0.02, 0.0, 0.0),
                        wrench=wrench((0.0, 0.1, 0.0)), duration=rospy.Duration.from_sec(1.0))
        self.tank.step(3)
        self.assertGreater(self.tank.state('probe').twist.angular.z, 0.05)

    def testWrenchesWhoseSumIsTooLargeAreRefusedAndTheFirstActs(self):
        second = rospy.Duration.from_sec(1.0)
        request = dict(body_name='probe', wrench=wrench((HUGE, 0.0, 0.0)), duration=second)
        self.assertTrue(self.tank.apply(**request).success)
        response = self.tank.apply(**request)
        self.assertFalse(response.success)
        for word in ('wrench', '"probe"', 'force [1.79e+308, 0, 0] N', 'expected a finite sum'):
            self.assertIn(word, response.status_message)
        # The other way it is none too many: nothing is left of both.
        request['wrench'] = wrench((-HUGE, 0.0, 0.0))
        self.assertTrue(self.tank.apply(**request).success)
        self.tank.step(2)
        self.assertLess(abs(self.tank.state('probe').twist.linear.x), 1e-3)

    def testBadAppliedWrenchesAreRefused(self):
        second = rospy.Duration.from_sec(1.0)
        good = wrench((1.0, 0.0, 0.0))
        cases = [(dict(body_name='bal', wrench=good, duration=second), ['bal', '"ball"']),
                 (dict(body_name='', wrench=good, duration=second), ['body_name']),
                 (dict(body_name='post', wrench=good, duration=second), ['post', 'fixed']),
                 (dict(body_name='ball', reference_frame='worl', wrench=good, duration=second), ['worl', '"world"']),
                 (dict(body_name='ball', wrench=wrench((NAN, 0.0, 0.0)), duration=second), ['wrench.force', 'finite']),
                 (dict(body_name='ball', wrench=wrench(torque=(0.0, 0.0, NAN)), duration=second), ['wrench.torque']),
                 (dict(body_name='ball', reference_point=Point(NAN, 0.0, 0.0), wrench=good, duration=second),
                  ['reference_point']),
                 (dict(body_name='ball', reference_point=Point(0.0, HUGE, 0.0), wrench=wrench((HUGE, 0.0, 0.0)),
                       duration=second), ['wrench', '"ball"', '-inf', 'expected finite']),
                 (dict(body_name='ball', wrench=good, start_time=rospy.Time(4294967295), duration=second),
                  ['start_time: value 4294967295 s', '1000000000 s']),
                 (dict(body_name='ball', wrench=good), ['duration', '0 s'])]
        self.tank.step(3)
        undisturbed = self.tank.state('ball')
        self.tank.reset()
        for request, words in cases:
            response = self.tank.apply(**request)
            self.assertFalse(response.success, str(request))
            for word in words:
                self.assertIn(word, response.status_message)
        response = self.tank.clear(body_name='prob')
        self.assertFalse(response.success)
        self.assertIn('"probe"', response.status_message)
        self.tank.step(3)
        self.unchanged('ball', undisturbed)

    # --- body states ---

    def testSetAndGetInAFrame(self):
        half = math.sqrt(0.5)
        response = self.tank.set(body_name='ball', reference_frame='probe', pose=pose(0.0, 0.07, 0.01),
                                 twist=twist((0.1, 0.0, 0.0)))
        self.assertTrue(response.success, response.status_message)
        # The probe is at (0.04, 0.04, 0.05), turned by 90 degrees: its y is the world's -x.
        state = self.tank.state('ball')
        for value, expected in zip((state.pose.position.x, state.pose.position.y, state.pose.position.z,
                                    state.pose.orientation.z, state.twist.linear.x, state.twist.linear.y),
                                   (-0.03, 0.04, 0.06, half, 0.0, 0.1)):
            self.assertAlmostEqual(value, expected)
        back = self.tank.state('ball', 'probe')
        self.assertEqual(back.header.frame_id, 'probe')
        self.assertAlmostEqual(back.pose.position.y, 0.07)
        self.assertAlmostEqual(back.twist.linear.x, 0.1)

    def testBadStatesAreRefused(self):
        here = pose(-0.04, 0.0, 0.05)
        cases = [(dict(body_name='balloon', pose=here), ['balloon', '"ball"']),
                 (dict(body_name='post', pose=here), ['post', 'fixed']),
                 (dict(body_name='ball', reference_frame='prob', pose=here), ['prob', '"probe"']),
                 (dict(body_name='ball', pose=pose(NAN, 0.0, 0.05)), ['pose.position', 'finite']),
                 (dict(body_name='ball', pose=pose(0.0, 0.0, 0.05, (0.0, 0.0, 0.0, 0.0))),
                  ['pose.orientation', 'length 1']),
                 (dict(body_name='ball', pose=pose(0.0, 0.0, 0.05, (NAN, 0.0, 0.0, 1.0))), ['pose.orientation']),
                 (dict(body_name='ball', pose=here, twist=twist((0.0, NAN, 0.0))), ['twist.linear']),
                 (dict(body_name='ball', pose=here, twist=twist(angular=(0.0, 0.0, float('inf')))), ['twist.angular']),
                 (dict(body_name='ball', pose=pose(0.3, 0.0, 0.05)), ['ball', 'tank']),
                 (dict(body_name='ball', pose=pose(0.0, 0.0, -5.0)), ['ball', 'tank']),
                 (dict(body_name='ball', pose=pose(0.04, 0.04, 0.06)), ['ball', 'probe'])]
        before = self.tank.state('ball')
        for request, words in cases:
            response = self.tank.set(**request)
            self.assertFalse(response.success, str(request))
            for word in words:
                self.assertIn(word, response.status_message)
            self.unchanged('ball', before)
        response = self.tank.get(body_name='balll')
        self.assertFalse(response.success)
        self.assertIn('"ball"', response.status_message)
        self.tank.step()  # and it goes on

    def values(self, part):
        """Of all diagnostics so far: message and values of a part, in their order."""
        return [(status.message, {value.key: value.value for value in status.values})
                for array in list(self.diagnostics.messages) for status in array.status if status.name.endswith(part)]

    def testDiagnosticsAreNotStampedInTheFuture(self):
        for _ in range(5):
            self.tank.step(50)
            rospy.rostime.wallsleep(0.2)
            self.diagnostics.clear()
            self.tank.reset()
            first = self.diagnostics.waitFor()[0]
            self.assertLessEqual(first.header.stamp, rospy.Time.from_sec(STEP_SEC))

    def testDiagnosticsGoOnDuringManySteps(self):
        begin = time.time()
        self.tank.step(50)
        # About three periods of a second.
        steps = int(3.0 * 50 / (time.time() - begin))
        self.tank.reset()
        rospy.rostime.wallsleep(0.3)  # what is still on its way
        self.diagnostics.clear()
        self.tank.step(steps)
        between = {int(values['Step']) for _, values in self.values('Solver')} - {0, steps}
        self.assertTrue(between)

    def testRealTimeFactorOfARunBeforeThePauseIsForgotten(self):
        self.diagnostics.clear()
        self.tank.unpause()
        waitUntil(lambda: any('of real time' in text for text, _ in self.values('Real-time factor')), 'a speed')
        self.tank.pause()
        rospy.rostime.wallsleep(0.2)
        self.diagnostics.clear()
        self.tank.unpause()
        waitUntil(lambda: self.values('Real-time factor'), 'diagnostics')
        self.assertEqual(self.values('Real-time factor')[0][0], 'Not known yet')

    def testDiagnosticsTellWhereThePausedRunStands(self):
        waitUntil(lambda: self.values('Solver') and self.values('Solver')[-1][0] == 'No step yet', 'a fresh start')
        self.assertEqual(self.values('Liquid')[-1][0], 'No step yet')
        self.tank.step(3)
        waitUntil(lambda: self.values('Solver')[-1][1]['Step'] == '3', 'the third step')
        text, values = self.values('Solver')[-1]
        self.assertEqual((text, values['Status']), ('Converged', 'converged'))
        self.assertLess(float(values['Residual']), 1e-4)
        text, values = self.values('Liquid')[-1]
        self.assertEqual(text, 'Volume kept')
        self.assertAlmostEqual(float(values['Volume (m^3)']), 0.16 * 0.16 * 0.08, delta=1e-4)
        self.assertLess(abs(float(values['Change since the start'])), 0.01)
        self.assertEqual(self.values('Real-time factor')[-1][0], 'Paused')

    def testDiagnosticsNameWhatWasRefused(self):
        self.tank.get(body_name='balll')
        waitUntil(lambda: self.values('Commands') and 'balll' in self.values('Commands')[-1][0], 'the refusal')
        text, values = self.values('Commands')[-1]
        self.assertTrue(text.startswith('Refused: ~get_body_state: body_name: value "balll"'), text)
        self.assertEqual('Refused: ' + values['Last refused'], text)

    def testDiagnosticsNameTheSolver(self):
        self.tank.step()
        waitUntil(lambda: any(status.name.endswith('Solver') and status.message == 'Converged'
                              for array in list(self.diagnostics.messages) for status in array.status),
                  'a healthy solver')
        names = {status.name.split(': ')[-1] for array in self.diagnostics.messages for status in array.status}
        self.assertLessEqual({'Solver', 'Liquid', 'Commands', 'Real-time factor'}, names)


if __name__ == '__main__':
    rostest.rosrun('monolith_tank', 'interface', InterfaceTest)
