# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Transforms along a chain of frames, in a bag and live."""

from bag_files import header, imu, Make, stamps, START, store, TF, write2
from flightmaker import changed
import numpy as np
import pytest
from reader_checks import refused, SMALL

from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import conjugate, product, rotate, turn
from quad_ident_ros.nodes.mapped import MappedTopics

PLACE, ATTITUDE = ('px', 'py', 'pz'), ('qw', 'qx', 'qy', 'qz')
TOPICS = {'pose': {'topic': '/tf', 'child': 'base_link'}, 'rate': {'topic': '/imu'}}
SLOW = 50_000_000       # ns between the transforms of the frame above
MOUNT = (0.3, -0.2, 1.0), tuple(turn([[0.1, 0.2, 0.3]])[0])


def drift(ns):
    """Return the place (n, 3) and attitude (n, 4) of odom in map: both at a constant rate."""
    t = (np.asarray(ns) - START)[:, None] * 1e-9
    return t * [1.0, -2.0, 0.5] + [5.0, 0.0, 0.0], turn(t * [0.0, 0.0, 0.7])


def below(place, attitude, record=SMALL):
    """Return place and attitude in a frame, of a record in the frame that this one is in."""
    back = conjugate(attitude)
    return (rotate(back, record.stack(*PLACE) - place), product(back, record.stack(*ATTITUDE)))


def messages(frame, child, at, place, attitude, topic='/tf'):
    """Return TFMessages of a frame at stamps, ns."""
    sent = []
    for ns, p, q in zip(at, place, attitude, strict=True):
        motion = {'translation': dict(zip('xyz', map(float, p), strict=True)),
                  'rotation': dict(zip('wxyz', map(float, q), strict=True))}
        sent.append((topic, TF, int(ns), {'transforms': [{
            'header': header(int(ns), frame), 'child_frame_id': child, 'transform': motion}]}))
    return sent


def odom(at=None):
    """Return map -> odom each 50 ms, or at other stamps."""
    at = np.arange(START - SLOW, stamps(SMALL)[-1] + SLOW + 1, SLOW) if at is None else at
    return messages('map', 'odom', at, *drift(at))


def base(frame='odom', child='base_link'):
    """Return odom -> base_link at the stamps of the record."""
    at = np.array(stamps(SMALL))
    return messages(frame, child, at, *below(*drift(at)))


def in_order(*parts):
    """Return messages in order of time."""
    return sorted((one for part in parts for one in part), key=lambda one: one[2])


def agrees(read, record=SMALL, within=1e-9):
    """Check that a record has the poses of another."""
    np.testing.assert_allclose(read.stack(*PLACE), record.stack(*PLACE), atol=within)
    both = np.abs(np.sum(read.stack(*ATTITUDE) * record.stack(*ATTITUDE), axis=1))
    np.testing.assert_allclose(both, 1.0, atol=1e-9)


def test_a_chain_is_composed_at_the_stamps_of_the_faster_link(tmp_path):
    """The frame of the vehicle is recognised by its usual name, too."""
    path = write2(tmp_path / 'bag', in_order(odom(), base(), imu(SMALL)))
    for mapping in (None, mapping_from({'topics': TOPICS}, 'm')):
        read = load(path, mapping)
        assert len(read) == len(SMALL)
        agrees(read)
        assert any('map -> odom -> base_link' in note for note in read.info['notes'])


def test_the_faster_link_may_be_the_upper_one(tmp_path):
    """A marker that moves, and in it a vehicle whose place there is published each 50 ms."""
    mount = [np.tile(part, (40, 1)) for part in MOUNT]
    at = START - SLOW + SLOW * np.arange(40)
    path = write2(tmp_path / 'bag', in_order(
        base('map', 'marker'), messages('marker', 'base_link', at, *mount), imu(SMALL)))
    upper = below(*drift(stamps(SMALL)))
    place = upper[0] + rotate(upper[1], np.array(MOUNT[0]))
    attitude = product(upper[1], np.array(MOUNT[1]))
    read = load(path, mapping_from({'topics': TOPICS}, 'm'))
    kept = changed(SMALL, **dict(zip((*PLACE, *ATTITUDE), [*place.T, *attitude.T], strict=True)))
    assert len(read) == len(SMALL)
    agrees(read, kept)


@pytest.mark.slow
def test_a_transform_that_does_not_change_is_read_beside_them(tmp_path):
    """It is published once, on /tf_static, and holds for the whole flight."""
    place, attitude = (np.tile(part, (len(SMALL), 1)) for part in MOUNT)
    at = stamps(SMALL)
    fixed = messages('world', 'map', [START - 10 ** 9], *np.array(MOUNT, object)[:, None],
                     topic='/tf_static')
    camera = messages('base_link', 'camera', [START - 10 ** 9], *np.array(MOUNT, object)[:, None],
                      topic='/tf_static')
    path = write2(tmp_path / 'bag', in_order(
        fixed, camera, messages('map', 'base_link', at, *below(place, attitude)), imu(SMALL)))
    agrees(load(path))


def test_poses_without_a_transform_of_the_frame_above_are_left_out(tmp_path):
    at = np.arange(START, START + 10 * SLOW, SLOW)
    path = write2(tmp_path / 'bag', in_order(odom(at), base(), imu(SMALL)))
    read = load(path)
    count = int(np.sum(np.array(stamps(SMALL)) <= at[-1]))
    assert len(read) == count < len(SMALL)
    agrees(read, SMALL.slice(0, count))


def test_the_frame_that_was_taken_of_several_is_said(tmp_path):
    """Rotors that turn are frames in that of the vehicle, as a simulator publishes them."""
    at = stamps(SMALL)
    rotors = messages('base_link', 'rotor_1', at, np.zeros((len(at), 3)),
                      turn(np.arange(len(at))[:, None] * [0.0, 0.0, 1.0]))
    read = load(write2(tmp_path / 'bag', in_order(base('map'), rotors, imu(SMALL))))
    assert 'topic /tf: the pose is that of base_link in map' in read.info['notes']


@pytest.mark.parametrize(('more', 'said'), [
    (messages('odom', 'map', [START], [(0, 0, 0)], [(1, 0, 0, 0)]), 'lead back to themselves'),
    (messages('world', 'odom', [START], [(0, 0, 0)], [(1, 0, 0, 0)]),
     "the frame 'odom' is in 'world' and in 'map'"),
    (messages('base_link', 'rotor', [START], [(0, 0, 0)], [(1, 0, 0, 0)]), None),
    (messages('map', 'base_link2/base_link', [START], [(0, 0, 0)], [(1, 0, 0, 0)]),
     'several frames (base_link, base_link2/base_link, odom)')])
def test_what_is_no_chain_is_refused(tmp_path, more, said):
    path = write2(tmp_path / 'bag', in_order(odom(), base(), imu(SMALL), more))
    if said is None:
        agrees(load(path))
    else:
        refused(path, said)


def test_links_that_are_never_there_together_are_named(tmp_path):
    path = write2(tmp_path / 'bag', in_order(odom([START]), base(), imu(SMALL)))
    refused(path, 'the transforms of map -> odom -> base_link are never there together',
            'on /tf_static')


def test_a_quaternion_that_is_none_in_the_frame_above_is_refused(tmp_path):
    bad = odom()
    bad[3][3]['transforms'][0]['transform']['rotation'] = dict.fromkeys('wxyz', 0.0)
    refused(write2(tmp_path / 'bag', in_order(bad, base(), imu(SMALL))),
            'the quaternion does not have length 1')


@pytest.mark.filterwarnings('error')
def test_numbers_of_a_damaged_message_end_in_a_sentence(tmp_path):
    """As the fuzzer found them: a quaternion whose square is no number any more."""
    wild = messages('world', 'map', [START], [(1e300, 0, 0)], [(1e300, 0, 0, 0)], '/tf_static')
    refused(write2(tmp_path / 'bag', in_order(wild, odom(), base(), imu(SMALL))),
            'the quaternion does not have length 1')


def twice_told(ns, place=(5.0, 0.0, 0.0)):
    """Return the message of a time that says that odom does not move in map."""
    return messages('map', 'odom', [ns], [place], [(1, 0, 0, 0)], '/tf_static')


BEFORE, LATER = START - 10 ** 9, START + 2 * SLOW + 1
BOTH = "the frame 'odom' is on /tf_static, so that it should not move, and elsewhere on /tf"


@pytest.mark.parametrize('ns', [BEFORE, LATER])
def test_a_frame_that_does_not_change_and_moves_is_refused(tmp_path, ns):
    """It would stand still in all poses, or have one wrong value."""
    refused(write2(tmp_path / 'bag', in_order(twice_told(ns), odom(), base(), imu(SMALL))),
            BOTH, 'publish it on one of them')


@pytest.mark.parametrize('ns', [BEFORE, LATER])
def test_a_frame_that_does_not_change_may_be_on_both_topics(tmp_path, ns):
    at = np.arange(START - SLOW, stamps(SMALL)[-1] + SLOW + 1, SLOW)
    still = (5.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    moved = messages('map', 'odom', at, *(np.tile(part, (len(at), 1)) for part in still))
    below_it = messages('odom', 'base_link', np.array(stamps(SMALL)),
                        SMALL.stack(*PLACE) - still[0], SMALL.stack(*ATTITUDE))
    agrees(load(write2(tmp_path / 'bag', in_order(twice_told(ns), moved, below_it, imu(SMALL)))))


def test_an_unused_frame_may_be_on_both_topics(tmp_path):
    camera = [messages('base_link', 'camera', [START + k], [(k, 0, 0)], [(1, 0, 0, 0)], topic)
              for k, topic in enumerate(('/tf_static', '/tf'))]
    agrees(load(write2(tmp_path / 'bag', in_order(odom(), base(), imu(SMALL), *camera))))


def live(topics, sent):
    """Return [(stamp, columns)] of the poses that messages give live."""
    make, found = Make(store()), []
    for topic, kind, ns, fields in sent:
        for role, stamp, values in topics.samples(topic, kind, ns + 7, make(kind, **fields)):
            assert role == 'pose'
            found.append((stamp, values))
    return found


@pytest.fixture
def topics():
    return MappedTopics(mapping_from({'topics': {'pose': TOPICS['pose']}}, 'm'), 'm')


def flown(begin=START, count=400):
    """Return stamps, places and attitudes in the map of 4 s, and the messages of both links."""
    at = begin + 10_000_000 * np.arange(count)
    t = (at - begin)[:, None] * 1e-9
    place, attitude = t * [0.3, 0.2, 0.1], turn(t * [0.2, 0.1, 0.4])
    where, turned = drift(at)
    back = conjugate(turned)
    slow = np.arange(begin - SLOW, at[-1] + SLOW + 1, SLOW)
    return at, place, attitude, in_order(
        messages('map', 'odom', slow, *drift(slow)),
        messages('odom', 'base_link', at, rotate(back, place - where), product(back, attitude)))


def test_a_chain_is_composed_live_as_in_a_bag(topics):
    at, place, attitude, sent = flown()
    found = live(topics, sent)
    assert [stamp for stamp, _ in found] == at.tolist()
    np.testing.assert_allclose([[values[name] for name in PLACE] for _, values in found], place,
                               atol=1e-9)
    both = np.sum([[values[name] for name in ATTITUDE] for _, values in found] * attitude, axis=1)
    np.testing.assert_allclose(np.abs(both), 1.0, atol=1e-9)
    assert topics.notes() == ['topic /tf: the pose is composed of map -> odom -> base_link']


def test_a_live_chain_stays_what_it_was_when_it_began(topics):
    """A localisation that is started in flight would make the vehicle jump."""
    at, _, _, sent = flown()
    first = live(topics, [one for one in sent if one[3]['transforms'][0]['child_frame_id']
                          == 'base_link'])
    assert len(first) == len(at)
    again = live(topics, flown(at[-1] + 10_000_000)[3])
    assert len(again) == len(at) and topics.notes() == []


def test_a_live_clock_that_begins_anew_begins_the_poses_anew(topics):
    count = len(live(topics, flown(START + 100 * 10 ** 9)[3]))
    found = live(topics, flown()[3])
    assert [stamp for stamp, _ in found] == flown()[0].tolist() and count == len(found)


@pytest.mark.slow
def test_live_transforms_are_forgotten(topics):
    """The memory does not grow with the flight, nor while the frame above is silent."""
    _, _, _, sent = flown(count=3000)
    live(topics, sent)
    [part] = topics._parts.values()
    links = part._transforms._links
    assert all(len(link.stamps) < 100 for link in links.values())


def test_one_quaternion_that_is_none_costs_one_live_pose(topics):
    """A second of poses waits for the frame above; they are not lost with the bad one."""
    at, _, _, sent = flown()
    above = [one for one in sent if one[3]['transforms'][0]['child_frame_id'] == 'odom'][::20]
    below = [one for one in sent if one[3]['transforms'][0]['child_frame_id'] == 'base_link']
    below[150][3]['transforms'][0]['transform']['rotation'] = dict.fromkeys('wxyz', 0.0)
    sent, whole = in_order(above, below), above[-1][2]
    make, found, refused = Make(store()), [], []
    for topic, kind, ns, fields in sent:
        found += [stamp for _, stamp, _ in topics.samples(topic, kind, ns, make(kind, **fields))]
        refused += filter(None, [topics.refused])
    assert found == [ns for k, ns in enumerate(at.tolist()) if ns <= whole and k != 150]
    [line] = refused
    assert 'the quaternion does not have length 1; publish a pose with an attitude' in line
    assert topics.left_out() == {'nan': 1}


def test_live_transforms_that_come_to_nothing_are_counted(topics):
    """Of both links: 30 twice, 20 from before the last ones; and 7 for which the other is late."""
    at, _, _, sent = flown()
    above, below = ([one for one in sent if one[3]['transforms'][0]['child_frame_id'] == name]
                    for name in ('odom', 'base_link'))
    later = flown(at[-1] + 10_000_000)[3]
    last = [one for one in later if one[3]['transforms'][0]['child_frame_id'] == 'base_link']
    whole = in_order(below, [one for one in above if one[2] <= at[-1]])
    found = live(topics, whole)
    assert topics.left_out() == {}      # a pose may still wait for the frame above
    sent = [below[-1]] * 30 + below[-21:-1] + [above[-3]]
    assert live(topics, sent) == []
    assert topics.left_out() == {'duplicated': 30, 'out_of_order': 21}
    assert topics.left_out() == {}
    waiting = len(at) - len(found)
    assert live(topics, last[:7]) == []
    assert topics.left_out() == {}
    assert topics.left_out(end=True) == {'dropped': 7 + waiting}
    assert topics.left_out(end=True) == {}


@pytest.mark.slow
def test_what_waits_when_a_live_clock_begins_anew_is_counted_as_dropped(topics):
    begin = START + 100 * 10 ** 9
    at, _, _, sent = flown(begin)
    found = live(topics, [one for one in sent if one[2] <= at[-1] - SLOW
                          or one[3]['transforms'][0]['child_frame_id'] == 'base_link'])
    again = live(topics, flown()[3])
    assert len(again) == len(at) and 0 < len(found) < len(at)
    assert topics.left_out() == {'dropped': len(at) - len(found)}


def test_transforms_of_other_frames_are_not_counted(topics):
    at, _, _, sent = flown()
    live(topics, in_order(sent, messages('map', 'camera', [START + 1, START + 2, START + 2],
                                         [(0, 0, 0)] * 3, [(1, 0, 0, 0)] * 3)))
    assert topics.left_out() == {}


def test_a_flight_too_short_to_know_its_chain_is_counted_as_dropped(topics):
    at, _, _, sent = flown(count=100)
    assert live(topics, sent) == [] and topics.left_out() == {}
    assert topics.left_out(end=True) == {'dropped': len(at)}


@pytest.mark.parametrize('ns', [BEFORE, START + 3 * 10 ** 9 + 1])
def test_a_frame_that_does_not_change_and_moves_is_refused_live(topics, ns):
    topics.samples('/tf', TF, BEFORE, Make(store())(TF, transforms=[]))
    with pytest.raises(InputError, match=BOTH):
        live(topics, in_order(twice_told(ns), flown()[3]))


def test_several_vehicles_are_refused_live(topics):
    topics = MappedTopics(mapping_from({'topics': {'pose': {'topic': '/tf'}}}, 'm'), 'm')
    with pytest.raises(InputError, match=r'several frames \(a, b\); name that of the vehicle'):
        live(topics, in_order(*(messages('map', name, [START + k * 10 ** 9 for k in range(4)],
                                         [(0, 0, 0)] * 4, [(1, 0, 0, 0)] * 4)
                                for name in 'ab')))
