"""Make definitions.json from an installed ROS 2 Jazzy: ``python make_definitions.py SHARE_FOLDER > definitions.json``.

For every message type we publish or record: its complete ``ros2msg`` text, as rosbag2 writes it into recordings, and its RIHS01 hash.
The text is the .msg file followed by the files it depends on (sorted, depth first, each once), each after a line of 80 ``=`` and a line
``MSG: package/Name``. Kept as data, so that recordings can be written where ROS is not installed.
"""

import json
import pathlib
import re
import sys

TYPES = (
    'diagnostic_msgs/msg/DiagnosticArray',
    'diagnostic_msgs/msg/DiagnosticStatus',
    'geometry_msgs/msg/PoseStamped',
    'geometry_msgs/msg/Vector3Stamped',
    'geometry_msgs/msg/WrenchStamped',
    'nav_msgs/msg/Odometry',
    'rosgraph_msgs/msg/Clock',
    'sensor_msgs/msg/Imu',
    'sensor_msgs/msg/JointState',
    'std_msgs/msg/Float64',
    'std_msgs/msg/String',
    'visualization_msgs/msg/Marker',
)
PRIMITIVES = {'bool', 'byte', 'char', 'float32', 'float64', 'int8', 'uint8', 'int16', 'uint16', 'int32', 'uint32', 'int64', 'uint64',
              'string'}
FIELD_TYPE = re.compile(r'(?:^|\n)\s*([a-zA-Z0-9_/]+)(?:\[[^\]]*\])?\s+')

# tf2_msgs is not among the wheels. Its text is this one line; the hash is the one that rosbags computes and that Jazzy's own tf2_msgs has.
TF_MESSAGE = 'geometry_msgs/TransformStamped[] transforms\n'
TF_MESSAGE_HASH = 'RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087'


def complete_text(share, package, text, seen):
    """Return the text followed by all texts it depends on; `seen` collects the names already there."""
    found = {name for name in FIELD_TYPE.findall(text) if name not in PRIMITIVES}
    for name in sorted(name if '/' in name else f'{package}/{name}' for name in found):
        if name not in seen:
            seen.add(name)
            inner_package, inner = name.split('/')
            inner_text = (share / inner_package / 'msg' / f'{inner}.msg').read_text()
            text += '\n' + '=' * 80 + f'\nMSG: {name}\n' + complete_text(share, inner_package, inner_text, seen)
    return text


def main(share):
    """Print the definitions found under the share folder as JSON."""
    definitions = {'tf2_msgs/msg/TFMessage': {'hash': TF_MESSAGE_HASH, 'text': complete_text(share, 'tf2_msgs', TF_MESSAGE, set())}}
    for type_name in TYPES:
        package, _, name = type_name.split('/')
        path = share / package / 'msg' / name
        hashes = json.loads(path.with_suffix('.json').read_text())['type_hashes']
        definitions[type_name] = {'hash': next(entry['hash_string'] for entry in hashes if entry['type_name'] == type_name),
                                  'text': complete_text(share, package, path.with_suffix('.msg').read_text(), set())}
    json.dump(definitions, sys.stdout, indent=1, sort_keys=True)
    sys.stdout.write('\n')


if __name__ == '__main__':
    main(pathlib.Path(sys.argv[1]))
