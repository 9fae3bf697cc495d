# SPDX-License-Identifier: Apache-2.0
"""Who may open the page."""

import pytest

from rigid_body_sim.view.access import COOKIE, Access


@pytest.mark.parametrize(('headers', 'allowed'), [
    ({'Host': '127.0.0.1:8080'}, True), ({'Host': 'localhost:8080'}, True),
    ({'Host': '[::1]:8080'}, True), ({'Host': 'evil.example:8080'}, False), ({}, False),
    ({'Host': 'localhost:8080', 'Origin': 'http://localhost:8080'}, True),
    ({'Host': 'localhost:8080', 'Origin': 'https://evil.example'}, False),
    ({'Host': 'localhost:8080', 'Origin': 'http://localhost:9999'}, False),
    ({'Host': 'localhost:8080', 'Origin': 'null'}, False)])
def test_locally_only_pages_that_came_from_here_get_through(headers, allowed):
    assert Access().allows('/', headers) == allowed
    assert Access().address(8080) == 'http://127.0.0.1:8080/'


def test_on_another_host_only_who_has_the_token_gets_through():
    access = Access('192.0.2.7')
    headers = {'Host': '192.0.2.7:8080'}
    path = access.address(8080).removeprefix('http://192.0.2.7:8080')
    assert access.allows(path, headers)
    assert access.allows('/', {**headers, 'Cookie': f'{COOKIE}={access.token}'})
    assert not access.allows('/', headers)
    assert not access.allows('/?token=guess', headers)
    assert not access.allows('/', {**headers, 'Cookie': f'{COOKIE}=guess'})
    assert not access.allows(path, {**headers, 'Origin': 'https://evil.example'})
    assert access.token != Access('192.0.2.7').token
