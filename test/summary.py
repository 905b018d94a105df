#!/usr/bin/env python3
"""Prints the failures in xunit result files and, last, 'N passed, N failed[, N skipped]'.

summary.py LOG RESULTS_FOLDER EXPECTED_FILE ...

Exit code 0 only if something passed, nothing failed and every expected file is there: a program that crashed leaves
none, or the stand-in named MISSING-... that catkin writes.
"""

import os
import sys
import xml.etree.ElementTree as ElementTree

MESSAGE_LINES = 40


def printFailure(title, text):
    lines = text.strip().splitlines()
    print('FAILED ' + title)
    for line in lines[-MESSAGE_LINES:]:
        print('    ' + line)


def logTail(log, result_file):
    """What the program printed that was to write result_file."""
    lines = []
    for line in log:
        if line.startswith('-- run_tests.py: execute commands'):
            lines = []
        elif line.startswith('-- run_tests.py: verify result') and result_file in line:
            return ''.join(lines)
        else:
            lines.append(line)
    return 'never started'


def isSummary(path):
    """rostest-NAME.xml repeats its test programs' own files, with one entry for each program."""
    return os.path.basename(path).startswith('rostest-')


def problemsOf(case):
    return case.findall('failure') + case.findall('error')


class Totals:
    def __init__(self, log):
        self.log = log
        self.passed = self.failed = self.skipped = 0

    def addCase(self, name, case):
        problems = problemsOf(case)
        if problems:
            self.failed += 1
            printFailure(name, '\n'.join(problem.text or problem.get('message') or '' for problem in problems))
        elif case.find('skipped') is not None or case.get('status') == 'notrun':
            self.skipped += 1
        else:
            self.passed += 1

    def addFile(self, path):
        group = os.path.splitext(os.path.basename(path))[0]
        try:
            root = ElementTree.parse(path).getroot()
        except ElementTree.ParseError as error:
            self.failed += 1
            printFailure(group, '%s: %s' % (path, error))
            return
        cases = list(root.iter('testcase'))
        for case in cases:
            if not isSummary(path):
                self.addCase('%s: %s.%s' % (group, case.get('classname', ''), case.get('name', '')), case)
            elif problemsOf(case):
                self.addMissing(path)
        if not cases:
            self.failed += 1
            printFailure(group, '%s: no test in it' % path)

    def addMissing(self, path):
        self.failed += 1
        printFailure(os.path.splitext(os.path.basename(path))[0] + ': ended without a result',
                     logTail(self.log, os.path.basename(path)))


def main(log_file, folder, *expected):
    with open(log_file, errors='replace') as file:
        log = file.readlines()
    found = [os.path.join(path, name) for path, _, names in sorted(os.walk(folder)) for name in sorted(names)
             if name.endswith('.xml') and not name.startswith('MISSING-')]
    totals = Totals(log)
    for path in found:
        totals.addFile(path)
    present = {os.path.realpath(path) for path in found}
    for path in expected:
        if os.path.realpath(path) not in present:
            totals.addMissing(path)
    skipped = ', %d skipped' % totals.skipped if totals.skipped else ''
    print('%d passed, %d failed%s' % (totals.passed, totals.failed, skipped))
    return 0 if totals.passed and not totals.failed else 1


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
