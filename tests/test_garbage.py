"""What is made to stay is not searched for garbage, as long as its owner is there."""

from __future__ import annotations

import gc

from hthor import gc_freeze


class Owner:
    """Something that keeps things."""


def test_what_is_kept_is_let_go_with_its_owner():
    gc.unfreeze()
    owner = Owner()
    gc_freeze.unfreeze_after(owner)
    gc_freeze.freeze_existing()
    assert gc.get_freeze_count() > 0
    del owner
    assert gc.get_freeze_count() == 0


def test_nothing_is_searched_while_much_is_made_and_the_collector_is_left_as_it_was():
    with gc_freeze.collection_paused():
        assert not gc.isenabled()
        with gc_freeze.collection_paused():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()
