#!/usr/bin/python3
"""The demo, recorded by rosbag and read back: names, rates, stamps, numbers, and the surface against the fill level."""

import math
import os
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import unittest

import rosbag
import rostest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from tank_client import NODE, allFinite, numbers

BAG = "run 1, 'demo'.bag"
DURATION_SEC = 1.0
STEP_SEC = 0.04
CELL = 0.01
TANK = 0.32
FILL_LEVEL = 0.16
BODIES = ['steel_sphere', 'aluminium_box', 'torus', 'light_ball', 'wood_cylinder']
# Of all bodies together no more than the tank's floor times this height, m.
LARGEST_RISE = 0.02


class BagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='monolith_bag_')
        # A path relative to the caller's directory, as users give it.
        cls.launched = subprocess.run(
            ['roslaunch', '--wait', 'monolith_tank', 'tank.launch', 'scene:=drop', 'duration:=%g' % DURATION_SEC,
             'paced:=false', 'progress:=true', 'bag:=' + BAG],
            cwd=cls.folder, env=dict(os.environ, PWD=cls.folder), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            universal_newlines=True, timeout=120, check=False)
        cls.topics = {}
        path = os.path.join(cls.folder, BAG)
        if os.path.exists(path):
            with rosbag.Bag(path) as bag:
                for topic, message, _ in bag.read_messages():
                    cls.topics.setdefault(topic, []).append(message)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def own(self, name):
        self.assertIn(NODE + '/' + name, self.topics, self.launched.stdout)
        return self.topics[NODE + '/' + name]

    def points(self, cloud):
        self.assertEqual(cloud.point_step, 36)
        self.assertFalse(cloud.is_bigendian)
        return list(struct.iter_unpack('<9f', bytes(cloud.data)))

    def testLaunchEndsAndClosesTheBag(self):
        self.assertEqual(self.launched.returncode, 0, self.launched.stdout)
        self.assertEqual(os.listdir(self.folder), [BAG], self.launched.stdout)
        self.assertIn('100 %', self.launched.stdout)

    def testTopics(self):
        expected = {'/clock', '/tf', '/tf_static', '/diagnostics'}
        expected |= {NODE + '/' + name for name in ('body_states', 'statistics', 'surface', 'markers', 'tank')}
        expected |= {NODE + '/' + body + '/odom' for body in BODIES}
        self.assertEqual(set(self.topics), expected, self.launched.stdout)

    def testEveryStateIsThereAtItsRate(self):
        steps = round(DURATION_SEC / STEP_SEC)
        every_step = ['body_states'] + [body + '/odom' for body in BODIES]
        for name, rate in [(name, 1.0 / STEP_SEC) for name in every_step] + [('surface', 10.0), ('statistics', 10.0)]:
            stamps = [message.header.stamp.to_sec() for message in self.own(name)]
            # The first step that is not before each period's end; the initial state has the stamp of one step.
            periods = math.floor(DURATION_SEC * rate + 1e-6)
            expected = [STEP_SEC * (1 + math.ceil(i / (rate * STEP_SEC) - 1e-6)) for i in range(periods + 1)]
            self.assertLessEqual(expected[-1], STEP_SEC * (1 + steps) + 1e-6)
            self.assertEqual(len(stamps), len(expected), name)
            for stamp, value in zip(stamps, expected):
                self.assertAlmostEqual(stamp, value, places=6, msg=name)
        tf_stamps = [transform.header.stamp for message in self.topics['/tf'] for transform in message.transforms]
        self.assertEqual(len(tf_stamps), (steps + 1) * len(BODIES))
        self.assertEqual(tf_stamps, sorted(tf_stamps))

    def testClockIsMonotonic(self):
        clock = [message.clock for message in self.topics['/clock']]
        self.assertEqual(clock, sorted(clock))
        self.assertGreater(clock[0].to_sec(), 0.0)
        self.assertAlmostEqual(clock[-1].to_sec(), DURATION_SEC + STEP_SEC, places=6)
        self.assertEqual(len(set(clock)), round(DURATION_SEC / STEP_SEC) + 1)

    def testNumbersAreFinite(self):
        for name in ['body_states', 'statistics'] + [body + '/odom' for body in BODIES]:
            for message in self.own(name):
                self.assertTrue(allFinite(message), name)

    def testBodiesFallAndStayInside(self):
        states = self.own('body_states')
        self.assertEqual(states[0].names, BODIES)
        for message in states:
            for pose in message.poses:
                self.assertLess(max(abs(pose.position.x), abs(pose.position.y)), 0.5 * TANK)
                self.assertGreater(pose.position.z, 0.0)
                length = math.sqrt(sum(getattr(pose.orientation, axis) ** 2 for axis in 'xyzw'))
                self.assertAlmostEqual(length, 1.0, places=9)
        for first, last in zip(states[0].poses, states[-1].poses):
            self.assertLess(last.position.z, first.position.z - 0.02)
        sphere = BODIES.index('steel_sphere')
        # It is in the liquid by then, which holds it back.
        self.assertGreater(max(message.liquid_wrenches[sphere].force.z for message in states), 0.1)

    def testOdometryAgreesWithTheStates(self):
        states = self.own('body_states')
        for index, body in enumerate(BODIES):
            for state, odometry in zip(states, self.own(body + '/odom')):
                self.assertEqual(numbers(state.poses[index]), numbers(odometry.pose.pose))
                self.assertEqual(odometry.child_frame_id, body)

    def testSurfaceStartsAtTheFillLevel(self):
        points = self.points(self.own('surface')[0])
        columns = (TANK / CELL) ** 2
        self.assertGreater(len(points), 0.8 * columns)
        # A surface that runs between two layers of cells has a point in each.
        self.assertLessEqual(len(points), 2 * columns)
        for point in points:
            self.assertAlmostEqual(point[2], FILL_LEVEL, delta=0.01 * CELL)
            self.assertAlmostEqual(point[5], 1.0, delta=1e-3)
            self.assertEqual(point[6:], (0.0, 0.0, 0.0))

    def testSurfaceStaysNearTheFillLevel(self):
        for cloud in self.own('surface'):
            points = self.points(cloud)
            self.assertEqual(len(points), cloud.width)
            for point in points:
                self.assertTrue(all(math.isfinite(value) for value in point))
                self.assertLessEqual(max(abs(point[0]), abs(point[1])), 0.5 * TANK + 1e-6)
                self.assertTrue(0.0 <= point[2] <= TANK)
                self.assertAlmostEqual(math.hypot(point[3], math.hypot(point[4], point[5])), 1.0, delta=1e-3)
            # What lies in the liquid raises the level by its volume over the tank's area.
            level = statistics.median(point[2] for point in points)
            self.assertGreater(level, FILL_LEVEL - CELL)
            self.assertLess(level, FILL_LEVEL + LARGEST_RISE + CELL)

    def testStatisticsTellOfTheLiquid(self):
        messages = self.own('statistics')[1:]  # the first is of the initial state
        volumes = [message.liquid_volume for message in messages]
        for message in messages:
            self.assertTrue(message.committed, message.message)
            self.assertTrue(message.liquid and message.viscosity and message.free_surface)
        self.assertAlmostEqual(volumes[-1], TANK * TANK * FILL_LEVEL, delta=0.01 * TANK * TANK * FILL_LEVEL)


if __name__ == '__main__':
    rostest.rosrun('monolith_tank', 'bag', BagTest)
