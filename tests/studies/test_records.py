"""Records of a long study are kept."""

import json
from dataclasses import dataclass

from ngdgc.studies.records import Recorded


@dataclass
class Record:
    number: int


def test_a_record_is_in_the_file_before_the_next_is_made(tmp_path):
    """Where a process that is killed leaves it; Ctrl-C returns those that there are."""
    path, seen = tmp_path / "records.jsonl", []

    def Made():
        yield from map(Record, range(2))
        raise KeyboardInterrupt

    def Told(record):
        seen.append((record, [json.loads(line)["number"] for line in path.read_text().splitlines()]))

    with open(path, "w", encoding="utf-8") as file:
        assert Recorded(Made(), file, Told) == [Record(0), Record(1)]
    assert seen == [(Record(0), [0]), (Record(1), [0, 1])]
