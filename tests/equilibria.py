"""Checks of equilibria in physical units, apart from how they were found."""

import numpy as np

from sim.compliant.equilibrium import Contact, _compliance, _Law, motion

B, F, K, J = 3, 2, 2, 3  # lanes, feet, points, joints
SCALE = (0.3, 0.2)


def drawn_contact():
    """A problem whose numbers are drawn, as large as those of small robots."""
    rng = np.random.default_rng(8)
    lever = rng.normal(size=(B, F, 3 * K, J))
    root = rng.normal(size=(B, 6, 6))
    return Contact(
        reach=rng.normal(size=(B, F, 3 * K, 6)),
        lever=lever,
        yield_=rng.uniform(1e-3, 3e-3, (B, F, J)),
        drift=rng.normal(size=(B, F, 3 * K)) * 1e-3,
        gap=rng.normal(size=(B, F, K)) * 1e-3,
        floor=rng.uniform(1e-4, 2e-4, (B, F, K)),
        friction=rng.uniform(0.3, 0.8, (B, F, K)),
        wrench=rng.normal(size=(B, 6)),
        inertia=root @ np.swapaxes(root, 1, 2),
        push=rng.uniform(0.0, 0.3, (B, F, K)),
    )


def law_of(contact):
    return _Law.of(contact, _compliance(contact, contact.yield_), SCALE)


def require_equilibrium(contact, found):
    """Complementarity, Coulomb's cone and law, and balance: newtons and metres.

    Forces are right within 1e-6 N, and feet creep by at most 1e-9 m either way.
    """
    u, f = motion(contact, found.twist, found.force), found.force
    normal, along = f[..., 2], np.linalg.norm(f[..., :2], axis=-1)
    way = np.linalg.norm(u[..., :2], axis=-1)
    gap = contact.gap + u[..., 2] + contact.floor * normal - contact.push * way
    pressed = normal > 1e-5
    assert normal.min() > -1e-6
    assert gap[~pressed].min(initial=0) > -1e-9
    assert np.abs(gap[pressed]).max(initial=0) < 1e-9
    assert (along - contact.friction * normal).max() < 1e-6
    inside = along < contact.friction * normal - 2e-6
    assert way[inside].max(initial=0) < 2e-9  # both directions together
    slides = pressed & (way > 1e-6)
    opposed = (f[..., :2] * u[..., :2]).sum(-1)[slides] / (along * way)[slides]
    assert opposed.max(initial=-1) < -1 + 1e-6
    pull = (np.swapaxes(contact.reach, 2, 3) @ f.reshape(*f.shape[:2], -1, 1)).sum(1)
    rest = (pull - contact.inertia @ found.twist[..., None])[..., 0] + contact.wrench
    assert np.abs(rest[:, :3]).max() < 1e-6
    return slides.any()
