"""One run of `limber dev mutation`: builds, records what reaches what, judges every mutant."""

import os
import random
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from limber_qa.mutation import build, programs, survivors, targets
from limber_qa.mutation.programs import RecordedTest, Verdict
from limber_qa.mutation.rewrite import Mutant


@dataclass(frozen=True)
class Result:
    """Of the mutants that were judged."""

    verdicts: dict[Mutant, Verdict]
    judged_in_part: set[survivors.Key]  # of several mutants with one key, not all were judged
    unreached: set[Mutant]
    reasons: dict[survivors.Key, str]
    stale: list[survivors.Key]

    def survived(self) -> list[Mutant]:
        return [mutant for mutant, verdict in self.verdicts.items() if not verdict.killed]

    def unlisted(self) -> list[Mutant]:
        """Survivors without a reason: a test is missing."""
        return [mutant for mutant in self.survived() if mutant.key not in self.reasons]

    def listed_but_killed(self) -> list[Mutant]:
        """The reason is not true; of several with one key, all must be found."""
        alive = {mutant.key for mutant in self.survived()} | self.judged_in_part
        return [
            mutant
            for mutant, verdict in self.verdicts.items()
            if verdict.killed and mutant.key in self.reasons and mutant.key not in alive
        ]

    def passed(self) -> bool:
        return not (self.unlisted() or self.listed_but_killed() or self.stale)


def run(
    names: list[str],
    sample: int | None,
    seed: int,
    seconds: float | None,
    say: Callable[[str], None],
) -> Result:
    """`names`: areas or files, all if empty. `sample` of their mutants, drawn with `seed`; none is
    begun later than `seconds` after the first.
    """
    jobs = os.cpu_count() or 1
    all_areas = targets.areas()
    files = targets.chosen(names, all_areas)
    areas = [area for area in all_areas if files & set(area.files)]
    texts, mutants = build.mutants_of(all_areas)
    say("building the test programs with all mutants in them")
    build.build(areas, texts, jobs)

    too_slow = [pattern for area in all_areas for pattern in area.without]
    paths = sorted({build.program(name) for area in areas for name in area.programs})
    compiled = set().union(*(programs.compiled(path) for path in paths))
    possible = [mutant for mutant in mutants if mutant.file in files and mutant.number in compiled]
    drawn = list(possible)
    random.Random(seed).shuffle(drawn)
    drawn = drawn[:sample]

    with ThreadPoolExecutor(jobs) as pool:
        cases = [(path, name) for path in paths for name in programs.test_names(path, too_slow)]
        say(f"{len(cases)} tests without a mutant")
        tests = list(pool.map(lambda case: programs.record(*case), cases))
        reaching = _reaching(tests, {mutant.number for mutant in drawn})
        say(f"{len(drawn)} of {len(possible)} mutants")
        end = None if seconds is None else time.monotonic() + seconds

        def judge(mutant: Mutant) -> Verdict | None:
            if end is not None and time.monotonic() > end:
                return None
            return programs.judge(mutant.number, reaching[mutant.number])

        judged = dict(_said(zip(drawn, pool.map(judge, drawn), strict=True), len(drawn), say))
    verdicts = {mutant: verdict for mutant, verdict in judged.items() if verdict is not None}
    reasons = survivors.load()
    return Result(
        verdicts={mutant: verdicts[mutant] for mutant in possible if mutant in verdicts},
        judged_in_part={mutant.key for mutant in possible if mutant not in verdicts},
        unreached={mutant for mutant in verdicts if not reaching[mutant.number]},
        reasons=reasons,
        stale=survivors.stale(reasons, mutants, files),
    )


def _reaching(tests: list[RecordedTest], numbers: set[int]) -> dict[int, list[RecordedTest]]:
    reaching: dict[int, list[RecordedTest]] = {number: [] for number in numbers}
    for test in tests:
        for number in test.reached & numbers:
            reaching[number].append(test)
    return reaching


def _said(
    pairs: Iterator[tuple[Mutant, Verdict | None]], total: int, say: Callable[[str], None]
) -> Iterator[tuple[Mutant, Verdict | None]]:
    """Passes all on, and says every hundred how far it is."""
    for count, pair in enumerate(pairs, 1):
        if count % 100 == 0:
            say(f"{count} of {total}")
        yield pair
