#pragma once

// The order of Bullet's manifolds after a collision phase on several threads. btCollisionDispatcherMt appends new ones as the threads
// happen to make them; the solver's result depends on their order.

class btDispatcher;
class btOverlappingPairCache;

namespace pliant {

/// Before the phase: notes which manifolds there are. Both do nothing where Bullet's task scheduler has one thread.
void noteManifolds( btDispatcher& dispatcher );
/// After it: puts the new ones into the order of their pairs, in which one thread makes them.
void orderNewManifolds( btDispatcher& dispatcher, btOverlappingPairCache& pairs );

} // namespace pliant
