#!/usr/bin/env python3
"""Draws work-precision plots of validation runs and writes REPORT.md.

report.py RUNS FOLDER

RUNS has a JSON object a line (validation/framework/run_record.h). FOLDER gets REPORT.md and a plot for each case.
"""

import json
import math
import os
import sys

KNOBS = ('cells_across', 'dt', 'tolerance', 'solver', 'discretisation')
KNOB_NAMES = {'cells_across': 'cell width', 'dt': 'time step', 'tolerance': 'tolerance'}


def readRuns(path):
    with open(path) as file:
        return [json.loads(line) for line in file if line.strip()]


def cost(run):
    """CPU seconds per simulated second; of a steady state, CPU seconds."""
    return run['cpu_s'] if run['steady'] else run['cpu_s'] / max(run['simulated_s'], 1e-30)


def costName(run):
    return 'CPU s to the steady state' if run['steady'] else 'CPU s per simulated s'


def fixedKnobs(run, varied):
    """What else a sweep's runs share: of a steady state the step means nothing."""
    ignored = {varied} | ({'dt'} if run['steady'] else set())
    return tuple(run[k] for k in KNOBS if k not in ignored)


def grouped(runs, key):
    groups = {}
    for run in runs:
        groups.setdefault(key(run), []).append(run)
    return groups


def sweeps(runs, varied):
    """Groups of at least two runs of one quantity that differ in one knob alone, finest first."""
    found = []
    for group in grouped(runs, lambda r: (r['variant'], r['quantity'], fixedKnobs(r, varied))).values():
        values = {r[varied] for r in group}
        if len(values) > 1:
            found.append(sorted(group, key=lambda r: r[varied], reverse=varied == 'cells_across'))
    return found


def slope(points):
    """Least squares of log y over log x."""
    points = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len({x for x, _ in points}) < 2:
        return None
    mx = sum(x for x, _ in points) / len(points)
    my = sum(y for _, y in points) / len(points)
    return sum((x - mx) * (y - my) for x, y in points) / sum((x - mx) ** 2 for x, _ in points)


def order(sweep, varied):
    fineness = (lambda r: 1.0 / r[varied]) if varied == 'cells_across' else (lambda r: r[varied])
    return slope([(fineness(r), abs(r['error'])) for r in sweep])


def percent(error):
    return '%.2g %%' % (100 * abs(error)) if abs(error) < 0.1 else '%.0f %%' % (100 * abs(error))


def number(value):
    return '%.3g' % value


def isOwn(run):
    return run['judged'] and run['discretisation'] == 'fitted' and run['solver'] == 'fast'


def dominant(runs):
    """What most of the error of a variant's best judged run comes from, and the terms: for each knob, how far the
    result moves between the run and the finest of the sweep through it."""
    terms = {}
    for varied, name in KNOB_NAMES.items():
        for sweep in sweeps(runs, varied):
            judged = [r for r in sweep if isOwn(r)]
            if not judged or varied == 'dt' and judged[0]['steady']:
                continue
            # The run that the sweeps have in common: of the cells, how far it is from twice as many by the last two.
            base = judged[0]
            other = sweep[1] if base is sweep[0] else sweep[0]
            if base is sweep[0] and varied == 'tolerance':
                continue
            scale = abs(base['result'] - base['reference']) / abs(base['error']) if base['error'] else 0.0
            if scale:
                terms[name] = max(terms.get(name, 0.0), abs(base['result'] - other['result']) / scale)
    if not terms:
        return None, terms
    return max(terms, key=terms.get), terms


def plotCase(name, runs, folder):
    # Here, so that the rest needs no package for plots.
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4.5))
    for (variant, quantity), group in sorted(grouped(runs, lambda r: (r['variant'], r['quantity'])).items()):
        fitted = [r for r in group if r['discretisation'] == 'fitted' and r['error']]
        for varied, marker, style in (('cells_across', 'o', '-'), ('dt', 's', '--'), ('tolerance', '^', ':')):
            for sweep in sweeps(fitted, varied):
                axes.loglog([cost(r) for r in sweep], [abs(r['error']) for r in sweep], marker + style, markersize=4,
                            linewidth=1, label='%s: %s, %s' % (variant, quantity, KNOB_NAMES[varied]))
        for run in group:
            if run['discretisation'] == 'fractions' and run['error']:
                axes.loglog([cost(run)], [abs(run['error'])], 'x', color='black', markersize=6)
    goals = sorted({r['goal'] for r in runs if r['goal'] and r['judged']})
    for goal in goals:
        axes.axhline(goal, color='grey', linewidth=0.8, linestyle='--')
    axes.set_xlabel(costName(runs[0]))
    axes.set_ylabel('relative error')
    axes.set_title(name)
    axes.grid(True, which='both', linewidth=0.3)
    if 0 < len(axes.get_legend_handles_labels()[1]) <= 12:
        axes.legend(fontsize=6)
    figure.tight_layout()
    figure.savefig(os.path.join(folder, name + '.png'), dpi=110)
    plt.close(figure)


def summaryRow(name, runs):
    judged = [r for r in runs if r['judged'] and r['error'] is not None]
    with_goal = [r for r in judged if r['goal']]
    failed = [r for r in runs if r.get('failure') or r['error'] is None and r['goal']]
    missed = [r for r in with_goal if abs(r['error']) > r['goal']]
    worst = max(with_goal, key=lambda r: abs(r['error']) / r['goal'], default=None)
    orders = [order(s, 'cells_across') for s in sweeps([r for r in judged if isOwn(r)], 'cells_across')]
    orders = sorted(o for o in orders if o is not None)
    time_orders = [order(s, 'dt') for s in sweeps([r for r in runs if r['error'] and not r['steady']], 'dt')]
    time_orders = sorted(o for o in time_orders if o is not None)
    term = dominant([r for r in runs if r['error'] is not None])[0] or ''
    costs = [cost(r) for r in judged]
    return '| [%s](#%s) | %s | %s | %s | %s | %s | %s | %s |' % (
        name, name,
        percent(worst['error']) + ' (%s, %g across)' % (worst['quantity'], worst['cells_across']) if worst else '',
        percent(worst['goal']) if worst else '',
        'failed: %d' % len(failed) if failed else
        'no goal' if not with_goal else 'met' if not missed else '%d of %d missed' % (len(missed), len(with_goal)),
        '%s to %s' % (number(min(costs)), number(max(costs))) if costs else '',
        number(orders[len(orders) // 2]) if orders else '',
        number(time_orders[len(time_orders) // 2]) if time_orders else '', term)


def caseSection(name, runs):
    lines = ['## ' + name, '', '![error against cost](%s.png)' % name, '',
             '| variant | quantity | across | dt, s | tolerance | boundary | result | reference | error | goal | %s |'
             % costName(runs[0]), '|---|---|---|---|---|---|---|---|---|---|---|']
    for r in runs:
        if r['error'] is None and (r.get('failure') or r['goal']):
            failure = r.get('failure') or '%s is no number' % r['quantity']
            lines.append('| %s | failed: %s | %s | %s | %s | %s | | | | | |' % (
                r['variant'], failure.replace('\n', ' '), number(r['cells_across']), number(r['dt']),
                number(r['tolerance']), r['discretisation']))
            continue
        goal = percent(r['goal']) if r['goal'] and r['judged'] else ''
        if goal and abs(r['error']) > r['goal']:
            goal += ' **missed**'
        lines.append('| %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s |' % (
            r['variant'], r['quantity'], number(r['cells_across']), '' if r['steady'] else number(r['dt']),
            number(r['tolerance']), r['discretisation'] + ('' if r['solver'] == 'fast' else ', ' + r['solver']),
            '%.5g' % r['result'], '%.5g' % r['reference'], percent(r['error']), goal, number(cost(r))))
    term, terms = dominant([r for r in runs if r['error'] is not None])
    if term:
        lines += ['', 'The result moves, from one refinement to the next, by ' + ', '.join(
            '%s (%s)' % (percent(size), knob) for knob, size in sorted(terms.items(), key=lambda t: -t[1])) +
            ': **%s** dominates.' % term]
    observed = []
    for varied, letter in (('cells_across', 'cell width'), ('dt', 'time step')):
        for sweep in sweeps([r for r in runs if r['error']], varied):
            p = order(sweep, varied)
            if p is not None and not (varied == 'dt' and sweep[0]['steady']) and sweep[0]['discretisation'] == 'fitted':
                observed.append('- %s, %s: %.2g in the %s (%g to %g)' % (
                    sweep[0]['variant'], sweep[0]['quantity'], p, letter, sweep[-1][varied], sweep[0][varied]))
    if observed:
        lines += ['', 'Orders observed:', ''] + observed
    return lines + ['']


def adviceRuns(runs):
    """Of the default method the failures, and in all runs the quantities that have a goal in any of the case's."""
    wanted = {r['quantity'] for r in runs if r['goal'] and not r.get('yes_or_no')}
    return [r for r in runs if r['discretisation'] == 'fitted' and r['solver'] == 'fast' and
            (r.get('failure') or r['quantity'] in wanted)]


def advice(cases):
    """For each wanted error and case, the cheapest numerics with which every variant stays below it."""
    lines = ['## Advice', '',
             'For each wanted error the cheapest numerics of the runs above with which the largest error over the '
             'case\'s variants stays below it, and what that cost. Every quantity counts that has a goal in any run of '
             'its case, also where the goal is left out because the grid is too coarse; what is only seen or not does '
             'not.', '',
             '| case | wanted error | cells across | dt, s | tolerance | CPU | |', '|---|---|---|---|---|---|---|']
    for name, runs in cases.items():
        usable = adviceRuns(runs)
        steady = bool(runs[0]['steady'])
        needed = {(r['variant'], r['quantity']) for r in usable if r['judged'] and not r.get('failure')}
        choices = []
        for key, group in grouped(usable, lambda r: (round(r['cells_across'], 3), None if steady else r['dt'],
                                                     r['tolerance'])).items():
            measured = [r for r in group if r['error'] is not None]
            if len(measured) == len(group) and {(r['variant'], r['quantity']) for r in group} == needed:
                choices.append((max(cost(r) for r in group), max(abs(r['error']) for r in group), key))
        for wanted in (0.1, 0.05, 0.02, 0.01, 0.005):
            good = [c for c in choices if c[1] <= wanted]
            if not good:
                continue
            price, _, (cells, dt, tolerance) = min(good)
            row = '| %s | %s | %g | %s | %s | %s | %s |' % (
                name, percent(wanted), cells, 'any' if dt is None else number(dt), number(tolerance), number(price),
                costName(runs[0]))
            if lines[-1].split('|')[3:] == row.split('|')[3:] and lines[-1].split('|')[1] == row.split('|')[1]:
                lines.pop()  # the same numerics reach the smaller error, too
            lines.append(row)
    return lines + ['']


def writeReport(runs, folder):
    cases = grouped(runs, lambda r: r['case'])
    first = runs[0]
    # Runs of several calls may have been put together.
    names = list(dict.fromkeys(r['commit'] for r in runs))
    commits = ('commit ' if len(names) == 1 else 'commits ') + ', '.join(names)
    total = {(r['case'], r['variant']) + tuple(r[k] for k in KNOBS): r['cpu_s'] for r in runs}
    lines = ['# Validation', '',
             'Made by `./tank validate` from %s on %s: %d runs, %.0f s of CPU, one thread each. An error is relative '
             'to the reference; a cost is CPU time per simulated second, or to reach the steady state. Dashed lines in '
             'the plots are goals, crosses the published method\'s volume fractions.' % (
                 commits, first['machine'], len(total), sum(total.values())), '',
             'Goals count for the runs at the case\'s own step and tolerance. *Order* is the median of the observed '
             'orders of convergence; *dominant* names what moves the result most when it alone is refined.', '',
             '| case | worst error against its goal | goal | | CPU s | order in h | in dt | dominant |',
             '|---|---|---|---|---|---|---|---|']
    lines += [summaryRow(name, group) for name, group in cases.items()] + ['']
    for name, group in cases.items():
        plotCase(name, [r for r in group if r['error'] is not None], folder)
        lines += caseSection(name, group)
    lines += advice(cases)
    with open(os.path.join(folder, 'REPORT.md'), 'w') as file:
        file.write('\n'.join(lines))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    runs = readRuns(sys.argv[1])
    if not runs:
        sys.exit('report.py: no runs in ' + sys.argv[1])
    os.makedirs(sys.argv[2], exist_ok=True)
    writeReport(runs, sys.argv[2])


if __name__ == '__main__':
    main()
