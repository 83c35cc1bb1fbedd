# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Labels that nobody reads before their time.

The process that flies the realities encloses what they were with a pad as long as the text, used
once (Vernam, 1926): the file on disk reveals nothing without the pad, whatever the reader's rights
on the files. The pad goes to the process that scores, over a pipe, and is never written down.
"""

import hashlib
import json
import secrets


class Broken(Exception):
    """The seal does not fit its key."""


def seal(labels):
    """Return the sealed bytes and the key of JSON-able labels."""
    text = json.dumps(labels, sort_keys=True).encode()
    pad = secrets.token_bytes(len(text))
    return _mixed(text, pad), pad + hashlib.sha256(text).digest()


def unseal(sealed, key):
    """Return the labels; raises Broken where the bytes were changed or the key is another's."""
    pad, digest = key[:-32], key[-32:]
    if len(pad) != len(sealed):
        raise Broken('the key is not as long as what it seals')
    text = _mixed(sealed, pad)
    if hashlib.sha256(text).digest() != digest:
        raise Broken('the labels were changed, or the key is of other labels')
    return json.loads(text)


def _mixed(one, other):
    return bytes(a ^ b for a, b in zip(one, other, strict=True))
