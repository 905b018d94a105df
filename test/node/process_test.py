#!/usr/bin/python3
"""The node as a process: exit codes, messages about what it cannot start with, a step that fails, shipped files."""

import glob
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosbag
import rosgraph
import roslaunch.arg_dump
import roslaunch.config
import roslib.packages
import rospkg
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from monolith_tank.msg import Statistics
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock, Log
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from tank_client import NODE, Collector, Tank, waitUntil, wrench

PACKAGE = rospkg.RosPack().get_path('monolith_tank')
SCENES = os.path.join(PACKAGE, 'test/node/scenes')
SMALL = os.path.join(SCENES, 'small.yaml')
PROGRAM = roslib.packages.find_node('monolith_tank', 'monolith_tank_node')[0]


def start(*arguments, name='monolith_tank'):
    return subprocess.Popen([PROGRAM, '__name:=' + name] + list(arguments), stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, universal_newlines=True)


class ProcessTest(unittest.TestCase):
    runs = 0

    @classmethod
    def setUpClass(cls):
        rospy.init_node('process_test')

    def finish(self, *arguments, timeout_sec=60, name=None):
        """Runs the node, under a name, and so with parameters, of its own unless told. Returns exit code and output."""
        ProcessTest.runs += 1
        process = start(*arguments, name=name or 'run_%d' % ProcessTest.runs)
        try:
            output, _ = process.communicate(timeout=timeout_sec)
        finally:
            process.kill()
        return process.returncode, output

    def refused(self, words, *arguments):
        code, output = self.finish(*arguments)
        self.assertEqual(code, 1, output)
        self.assertIn('FATAL', output)
        for word in words:
            self.assertIn(word, output)

    def sceneWith(self, change):
        """A file beside small.yaml's URDFs with a changed scene."""
        with open(SMALL) as stream:
            scene = yaml.safe_load(stream)
        for body in scene['bodies']:
            body['urdf'] = os.path.join(SCENES, body['urdf'])
        change(scene)
        file = tempfile.NamedTemporaryFile('w', suffix='.yaml', delete=False)
        self.addCleanup(os.remove, file.name)
        with file:
            yaml.safe_dump(scene, file)
        return file.name

    # --- scenes that cannot be simulated ---

    def testMissingFile(self):
        self.refused(['~scene', '/nowhere/scene.yaml', 'no such file'], '_scene:=/nowhere/scene.yaml')

    def testMisspeltShippedScene(self):
        self.refused(['dorp', '"drop"'], '_scene:=dorp')

    def testUnknownKeyNamesFileAndNearestKey(self):
        file = self.sceneWith(lambda scene: scene['liquid'].update(desnity=3.0))
        self.refused([file, 'desnity', '"density"'], '_scene:=' + file)

    def testMalformedFile(self):
        file = tempfile.NamedTemporaryFile('w', suffix='.yaml', delete=False)
        self.addCleanup(os.remove, file.name)
        with file:
            file.write('tank: [1, 2\n')
        self.refused([file.name], '_scene:=' + file.name)

    def testOverlappingBodies(self):
        file = self.sceneWith(lambda scene: scene['bodies'][1].update(position=[-0.03, 0.0, 0.05]))
        self.refused(['ball', 'probe', 'overlap'], '_scene:=' + file)

    def testBodyNamedAsTheWorldFrame(self):
        self.refused(['ball', '~world_frame'], '_scene:=' + SMALL, '_world_frame:=ball')

    def testWorldFrameNamedAsALinksFrame(self):
        self.refused(['small.yaml', 'body "ball"', 'link "core"', '"ball/core"', '~world_frame'], '_scene:=' + SMALL,
                     '_world_frame:=ball/core')

    def testBodyNamedAsAParameter(self):
        file = self.sceneWith(lambda scene: scene['bodies'][1].update(name='paced'))
        self.refused([file + ':', 'bodies[1].name: value paced: expected another name', '~paced/robot_description'],
                     '_scene:=' + file)

    def testNoNameOfAParameterIsOneOfSeveralViolations(self):
        def change(scene):
            del scene['bodies'][0]['urdf']
            scene['bodies'][0]['urdf_parameter'] = 'foo bar'
            scene['liquid']['density'] = -1.0
        file = self.sceneWith(change)
        self.refused([file + ':', 'bodies[0].urdf_parameter: value foo bar: expected the name of a ROS parameter',
                      'liquid.density'], '_scene:=' + file)

    # --- parameters ---

    def testNoScene(self):
        self.refused(['~scene: missing'])

    def testUnknownParameterAndWrongValuesAllAtOnce(self):
        self.refused(['~start_pause: unknown', '~start_paused', '~state_rate: value 0', '> 0', '~paced: value 3',
                      'true or false'],
                     '_scene:=' + SMALL, '_start_pause:=true', '_state_rate:=0', '_paced:=3')

    # --- runs ---

    def testBoundedRunEndsByItself(self):
        code, output = self.finish('_scene:=' + SMALL, '_paced:=false', '_duration:=0.2', '_progress:=true')
        self.assertEqual(code, 0, output)
        self.assertIn('(100 %)', output)
        self.assertNotIn('use_sim_time', output)

    def testWithoutSimulatedTimeForOthersItSaysSoAndKeepsItsOwn(self):
        rospy.delete_param('/use_sim_time')
        self.addCleanup(rospy.set_param, '/use_sim_time', True)
        clock, statistics = Collector('/clock', Clock), Collector(NODE + '/statistics', Statistics)
        process = start('_scene:=' + SMALL, '_start_paused:=true', '_duration:=0')
        try:
            tank = Tank()
            clock.clear()  # of runs before
            self.assertAlmostEqual(tank.step(3).to_sec(), 0.08)
            self.assertAlmostEqual(tank.state('ball').header.stamp.to_sec(), 0.08)
            before = tank.state('ball').twist.linear.x
            # In the third step from now.
            self.assertTrue(tank.apply(body_name='ball', wrench=wrench((0.02, 0.0, 0.0)),
                                       start_time=rospy.Time.from_sec(0.12),
                                       duration=rospy.Duration.from_sec(0.02)).success)
            tank.step(2)
            self.assertLess(abs(tank.state('ball').twist.linear.x - before), 1e-4)
            tank.step(1)
            self.assertGreater(tank.state('ball').twist.linear.x - before, 1e-3)
            tank.unpause()
            waitUntil(lambda: statistics.messages and statistics.messages[-1].header.stamp.to_sec() > 0.3,
                      'simulated time to go on')
            self.assertLess(statistics.messages[-1].header.stamp.to_sec(), 60.0)
            # Nobody would follow it.
            self.assertEqual(clock.messages, [])
        finally:
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=10)
            process.kill()
        self.assertEqual(process.returncode, 0, output)
        self.assertIn('/use_sim_time is not set', output)

    def summaries(self, change, part):
        """What /diagnostics says first of a part of a running scene, once it says something: level and message."""
        ProcessTest.runs += 1
        diagnostics = Collector('/diagnostics', DiagnosticArray)
        process = start('_scene:=' + self.sceneWith(change), '_duration:=0', '_diagnostic_period:=0.2',
                        name='run_%d' % ProcessTest.runs)

        def found():
            return [(status.level if isinstance(status.level, int) else ord(status.level), status.message)
                    for array in list(diagnostics.messages) for status in array.status
                    if status.name.endswith(part) and status.message not in ('No step yet', 'Not known yet')]
        try:
            waitUntil(found, 'diagnostics of ' + part)
        finally:
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=10)
            process.kill()
        self.assertEqual(process.returncode, 0, output)
        return found()

    def testRunThatDoesNotKeepUpIsAWarning(self):
        level, message = self.summaries(lambda scene: scene.update(time_step=1e-4), 'Real-time factor')[0]
        self.assertEqual(level, 1, message)
        self.assertRegex(message, r'^Slower than real time: 0\.')

    def testDryTankHasNoVolumeToKeep(self):
        level, message = self.summaries(lambda scene: scene.pop('liquid'), 'Liquid')[0]
        self.assertEqual((level, message), (0, 'No liquid'))

    def testVolumeThatChangesInTheFirstStepIsAWarning(self):
        def leaving(scene):
            scene['liquid'].update(fill_level=0.16)
            scene.update(time_step=0.5)
            for body in scene['bodies']:
                body.update(motion='prescribed', prescribed={'twist': [0, 0, 1, 0, 0, 0]})
        level, message = self.summaries(leaving, 'Liquid')[0]
        self.assertEqual(level, 1, message)
        self.assertRegex(message, r'^Volume changed by [1-9]')

    def testDurationIsRoundedUpToWholeSteps(self):
        # The initial state has the stamp of one step, 0.02 s.
        for duration, end in (('0.001', 0.04), ('0.51', 0.54), ('0.5', 0.52)):
            clock = Collector('/clock', Clock)
            code, output = self.finish('_scene:=' + SMALL, '_paced:=false', '_duration:=' + duration)
            self.assertEqual(code, 0, output)
            self.assertAlmostEqual(clock.messages[-1].clock.to_sec(), end)

    def testProcessHasItsOwnName(self):
        process = start('_scene:=' + SMALL, '_start_paused:=true', '_duration:=0')
        try:
            Tank()  # by then it has started over, with OpenMP as it wants it
            with open('/proc/%d/comm' % process.pid) as stream:
                self.assertEqual(stream.read().strip(), os.path.basename(PROGRAM)[:15])
        finally:
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=10)
            process.kill()
        self.assertEqual(process.returncode, 0, output)

    def testAnotherClockIsSaid(self):
        other = rospy.Publisher('/clock', Clock, queue_size=1)
        try:
            code, output = self.finish('_scene:=' + SMALL, '_duration:=0.02', '_paced:=false')
        finally:
            other.unregister()
        self.assertEqual(code, 0, output)
        self.assertIn(rospy.get_name() + ' publishes /clock too', output)
        code, output = self.finish('_scene:=' + SMALL, '_duration:=0.02', '_paced:=false')
        self.assertNotIn(rospy.get_name() + ' publishes', output)

    def testAClockThatWasKilledIsNone(self):
        process = start('_scene:=' + SMALL, '_start_paused:=true', '_duration:=0')
        try:
            Tank()
        finally:
            process.kill()
        process.communicate()
        self.addCleanup(self.finish, '_scene:=' + SMALL, '_start_paused:=false', '_duration:=0.02', '_paced:=false',
                        name='monolith_tank')
        code, output = self.finish('_scene:=' + SMALL, '_duration:=0.02', '_paced:=false')
        self.assertEqual(code, 0, output)
        self.assertNotIn(NODE + ' publishes', output)

    def testFramesOfAnotherNodeAreSaidAndAPrefixKeepsThemApart(self):
        frames, odometry = Collector('/tf', TFMessage), Collector('/run_right/ball/odom', Odometry)
        static = Collector('/tf_static', TFMessage)
        process = start('_scene:=' + SMALL, '_start_paused:=true', '_duration:=0')
        try:
            Tank()
            arguments = ['_scene:=' + SMALL, '_duration:=0.4', '_paced:=true']
            code, output = self.finish(*arguments, name='run_left')
            self.assertEqual(code, 0, output)
            for moved in ('"ball", "probe", "post"',
                          '"world/tank", "ball/core", "probe/cube", "probe/tip", "post/core"'):
                self.assertEqual(output.count(NODE + ' publishes tf frames of this node too: ' + moved + ';'), 1,
                                 output)
            frames.clear()
            static.clear()
            code, output = self.finish(*arguments, '_frame_prefix:=right/', name='run_right')
            self.assertEqual(code, 0, output)
            self.assertNotIn('publishes tf frames', output)
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=10)
            process.kill()
        self.assertEqual({message.child_frame_id for message in odometry.messages}, {'right/ball'})
        pairs = {(transform.header.frame_id, transform.child_frame_id) for collector in (frames, static)
                 for message in list(collector.messages) for transform in message.transforms}
        self.assertTrue({('world', 'right/ball'), ('world', 'right/world/tank'), ('right/ball', 'right/ball/core')}
                        <= pairs, pairs)

    def testPacedRunKeepsToRealTime(self):
        begin = time.time()
        code, output = self.finish('_scene:=' + SMALL, '_duration:=2.0', '_progress:=true')
        wall = time.time() - begin
        self.assertEqual(code, 0, output)
        # Beside the run itself: starting, and half a second for the last messages.
        self.assertGreater(wall, 2.0)
        self.assertLess(wall, 6.0)

    def testRateBeyondTheStepIsSaid(self):
        code, output = self.finish('_scene:=' + SMALL, '_paced:=false', '_duration:=0.04', '_state_rate:=500.0')
        self.assertEqual(code, 0, output)
        self.assertRegex(output, 'state_rate: 500 Hz.*0.02 s.*50 Hz')

    def testEndOfRosTimeIsNoFailureToStart(self):
        def longest(scene):
            del scene['bodies']
            del scene['liquid']
            scene['time_step'] = 1e6
        code, output = self.finish('_scene:=' + self.sceneWith(longest), '_paced:=false')
        self.assertEqual(code, 1, output)
        self.assertRegex(output, r'Stopped at 4\.29\S* s: .*expected at most 4294967295 s')
        self.assertNotIn('Cannot start', output)

    def testStepsEndWithTheRunAndNothingChangesItsEnd(self):
        clock = Collector('/clock', Clock)
        process = start('_scene:=' + SMALL, '_start_paused:=true', '_duration:=0.2')
        try:
            tank = Tank()
            response = tank.stepService(steps=20)
            self.assertFalse(response.success)
            self.assertIn('after 10 of 20 steps: ~duration is over', response.message)
            self.assertAlmostEqual(response.time.to_sec(), 0.22)
            time.sleep(0.1)
            self.assertRaises(rospy.ServiceException, tank.reset)
            output, _ = process.communicate(timeout=10)
        finally:
            process.kill()
        self.assertEqual(process.returncode, 0, output)
        self.assertAlmostEqual(clock.messages[-1].clock.to_sec(), 0.22)

    def testInterruptAndTerminationEndCleanly(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            statistics = Collector(NODE + '/statistics', Statistics)
            process = start('_scene:=' + SMALL, '_start_paused:=false', '_duration:=0')
            try:
                statistics.waitFor(2)
                process.send_signal(number)
                output, _ = process.communicate(timeout=10)
            finally:
                process.kill()
            statistics.subscriber.unregister()
            self.assertEqual(process.returncode, 0, output)
            # The master has been told.
            known = [node for topics in rosgraph.Master('/process_test').getSystemState() for _, nodes in topics
                     for node in nodes]
            self.assertNotIn(NODE, known)

    def testStepThatFailsPausesAndKeepsTheState(self):
        def unsolvable(scene):
            scene['solver'].update(tolerance=1e-12, maximum_iterations=1)
        statistics, log = Collector(NODE + '/statistics', Statistics), Collector('/rosout', Log)
        diagnostics = Collector('/diagnostics', DiagnosticArray)
        process = start('_scene:=' + self.sceneWith(unsolvable), '_start_paused:=true', '_duration:=0')
        try:
            tank = Tank()
            before = tank.state('ball')
            waitUntil(lambda: statistics.subscriber.get_num_connections() and
                      diagnostics.subscriber.get_num_connections(), 'topics')
            tank.unpause()
            waitUntil(lambda: any(not message.committed and message.status == 'not converged'
                                  for message in statistics.messages), 'the failed step on ~statistics')
            waitUntil(lambda: any(status.level in (2, b'\x02') and 'not committed' in status.message
                                  for array in list(diagnostics.messages) for status in array.status),
                      'the failed step on /diagnostics')
            after = tank.state('ball')
            self.assertEqual(after.header.stamp, before.header.stamp)
            self.assertEqual(after.pose, before.pose)
            # Paused: it takes single steps again, and they fail again.
            response = tank.stepService(steps=1)
            self.assertFalse(response.success)
            self.assertTrue(response.message)
            tank.reset()
            waitUntil(lambda: any(message.level == Log.ERROR and 'not committed' in message.msg
                                  for message in list(log.messages)), 'the error on /rosout')
        finally:
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=10)
            process.kill()
        self.assertEqual(process.returncode, 0, output)

    # --- what ships ---

    def testEveryShippedSceneRuns(self):
        scenes = [os.path.splitext(os.path.basename(file))[0] for file in glob.glob(PACKAGE + '/config/scenes/*.yaml')]
        self.assertGreaterEqual(len(scenes), 4)
        for scene in sorted(scenes):
            code, output = self.finish('_scene:=' + scene, '_paced:=false', '_duration:=0.04')
            self.assertEqual(code, 0, output)

    def testSceneTemplateRuns(self):
        code, output = self.finish('_scene:=' + PACKAGE + '/config/scene_template.yaml', '_paced:=false',
                                   '_duration:=0.04')
        self.assertEqual(code, 0, output)

    def testNodeParameterFilesLoad(self):
        for file in ('node.yaml', 'node_template.yaml'):
            with open(os.path.join(PACKAGE, 'config', file)) as stream:
                parameters = yaml.safe_load(stream)
            parameters.update(scene=SMALL, duration=0.04, paced=False)
            rospy.set_param('/run_%d' % (ProcessTest.runs + 1), parameters)
            code, output = self.finish()
            self.assertEqual(code, 0, output)

    def launch(self, *arguments, **environment):
        return subprocess.run([sys.executable, PACKAGE + '/launch/supervise.py', '-', PACKAGE + '/launch/tank.launch',
                               'scene:=' + SMALL] + list(arguments), env=dict(os.environ, **environment),
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=60,
                              check=False)

    def testLaunchInANamespaceEndsAndRecords(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        bag = os.path.join(folder, 'run.bag')
        run = self.launch('duration:=0.2', 'paced:=false', 'bag:=' + bag, ROS_NAMESPACE='/harbour/basin')
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertNotIn('nobody subscribed', run.stdout)
        with rosbag.Bag(bag) as recorded:
            topics = recorded.get_type_and_topic_info().topics
        self.assertIn('/harbour/basin/monolith_tank/body_states', topics)

    def testLaunchThatCannotRecordEndsAndFails(self):
        # Parameters stay: they are those of no other test's node.
        run = self.launch('duration:=30', 'bag:=/nowhere/run.bag', ROS_NAMESPACE='/harbour/dock')
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn('/nowhere/run.bag', run.stdout)

    def testLaunchFilesLoadAndExplainTheirArguments(self):
        files = glob.glob(PACKAGE + '/launch/*.launch')
        self.assertTrue(files)
        for file in files:
            for arguments in ([], ['scene:=stack', 'duration:=1', 'bag:=x.bag', 'rviz:=true', 'paced:=false'],
                              ['scene:=some/where.yaml', 'rviz:=true']):
                config = roslaunch.config.load_config_default([(file, arguments)], None, verbose=False)
                self.assertFalse(config.config_errors)
                for node in config.nodes:
                    # rviz is installed where there is a display only.
                    if node.package != 'rviz':
                        self.assertTrue(roslib.packages.find_node(node.package, node.type), node.type)
                    for path in re.findall(r'\S+\.rviz', node.args):
                        self.assertTrue(os.path.exists(path), path)
            with open(file) as stream:
                for argument in re.findall(r'<arg\s[^>]*>', stream.read()):
                    self.assertIn('doc="', argument)
            # What `roslaunch --ros-args` shows: an argument without a default, or with an empty one, as required.
            for name, (_, default) in roslaunch.arg_dump.get_args([file]).items():
                self.assertTrue(default, name)


if __name__ == '__main__':
    rostest.rosrun('monolith_tank', 'process', ProcessTest)
