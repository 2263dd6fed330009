#pragma once

// All state of a world with soft bodies that is carried from step to step: written, or read completely and then put in place.

#include "pliant/io/snapshot.h"
#include "world/io/body_record.h"
#include "world/io/broadphase_record.h"
#include "world/io/child_contacts.h"
#include "world/io/manifold_record.h"
#include "world/step/world_step.h"

#include <memory>
#include <vector>

namespace pliant {

class WorldSnapshot
{
public:
	explicit WorldSnapshot( WorldStep& step ) : m_step( step ), m_bodies( step.bodies ) {}

	void write( Archive& archive, const SaveSettings& settings );
	/// Reads everything and checks it against the world, which stays as it is.
	void read( Archive& archive, const LoadSettings& settings );
	/// Makes the world the one that was read.
	void commit( RestoredWorld& report );

private:
	/// An object of the world: a soft body by its index in m_records, or another by its number.
	struct Entry
	{
		int record = -1;
		std::int64_t id = 0;
		int type = 0, shape = 0; ///< Bullet's, to recognise a wrong object
		ObjectState state;
		btCollisionObject* object = nullptr; ///< the matching object of the world; a soft body's is set when it is in place
		void archive( Archive& archive );
	};
	/// A ghost with its overlapping objects, in its order.
	struct GhostRecord
	{
		int ghost = -1;
		std::vector<int> overlaps; ///< objects
		void archive( Archive& archive ) { archive( ghost, overlaps ); }
	};
	/// A pair of the broadphase, of a body with itself, or of a ghost's own cache (btPairCachingGhostObject), in which a character finds
	/// contacts.
	struct PairRecord
	{
		int ghost = -1;              ///< object; -1: the world's pair
		int first = -1, second = -1; ///< objects
		bool hasAlgorithm = false, isSoft = false;
		PairContacts::Carried soft;
		std::vector<ChildPair> children; ///< of compounds, in the order of their manifolds
		int contacts = 0;                ///< number of its manifolds, which follow those of the pairs before it
		void archive( Archive& archive );
	};
	struct AttachmentRecord
	{
		Attachment attachment;
		int first = -1, second = -1, rigid = -1; ///< objects
		void archive( Archive& archive );
	};
	/// A frame whose rigid body is in the world.
	struct FrameRecord
	{
		int rigid = -1, body = -1; ///< objects; body -1: the patch no longer exists
		Frame frame;               ///< without its shape and its rigid body
		void archive( Archive& archive );
	};
	struct OutsideRecord
	{
		int object = -1;
		Vector6 change = Vector6::Zero();
		void archive( Archive& archive );
	};
	/// Numbers of the world.
	struct Values
	{
		unsigned serials = 0;
		WorldStep::Lengths lengths;
		btScalar localTime = 0, fixedStep = 0;
		double clock = 0.0; ///< SoftBodySystem's
		int nextAttachment = 0;
		std::vector<OutsideRecord> outside[2];
		std::vector<unsigned> asleep; ///< serials
		void archive( Archive& archive );
	};

	// Writing.
	void collect( const SaveSettings& settings );
	void writeTemplates( Archive& archive, bool areStored );
	void collectValues();
	void collectAttachments();
	void collectFrames();
	void collectPairs();
	void collectPairsOf( btOverlappingPairCache& cache, int ghost );
	void collectGhosts();
	void addPair( PairRecord&& record, const PairContacts* soft, btCollisionAlgorithm* algorithm );
	void writeManifolds( Archive& archive, bool areNumbered );
	int indexOf( const btCollisionObject* object ) const { return object ? object->getWorldArrayIndex() : -1; }

	// Reading.
	void readTemplates( Archive& archive, const LoadSettings& settings );
	std::shared_ptr<const BodyTemplate> templateOf( std::uint64_t fingerprint, const LoadSettings& settings ) const;
	void findObjects( Archive& archive, const LoadSettings& settings );
	void readBodies( Archive& archive );
	void checkReferences( Archive& archive );
	void checkFrames( Archive& archive );
	void checkGhosts( Archive& archive ) const;
	void readManifolds( Archive& archive );
	void checkPair( Archive& archive, const PairRecord& pair ) const;
	bool isSoft( int object ) const { return m_entries[std::size_t( object )].record >= 0; }
	bool isObject( int object ) const { return object >= 0 && std::size_t( object ) < m_entries.size(); }
	bool isBodyNode( int object, int node ) const;
	bool hasNodes( int object ) const;

	// Putting in place.
	void endContacts();
	void endPairs( btOverlappingPairCache& cache );
	void removeOthers( RestoredWorld& report );
	void placeBodies( RestoredWorld& report );
	void orderObjects();
	void restoreReferences();
	void restoreFrames();
	void restoreGhosts();
	void restorePairs();
	void restorePair( const PairRecord& record, const ManifoldRecord* contacts );
	void restoreSelfContacts( const PairRecord& record, const ManifoldRecord* contacts );
	void fillManifolds(
		const PairRecord& record, const ManifoldRecord* contacts, const btAlignedObjectArray<btPersistentManifold*>& manifolds );
	void orderTouched( SoftBody& body ) const;
	void restoreValues();

	/// The pairs that a ghost keeps itself; null where it keeps none, or is none.
	static btOverlappingPairCache* cacheOf( btCollisionObject& object );

	WorldStep& m_step;
	SoftBodySystem& m_bodies;
	std::vector<std::shared_ptr<const BodyTemplate>> m_templates;
	std::vector<Entry> m_entries; ///< in the order of the world's list
	std::vector<BodyRecord> m_records;
	std::vector<SoftBody*> m_live;           ///< by record: the body of the world that is to be it; null: a new one
	std::vector<std::vector<int>> m_touched; ///< by record: its touched nodes, in their order
	std::vector<int> m_familySizes;
	std::vector<std::vector<CutTrace>> m_cuts;
	std::vector<AttachmentRecord> m_attachments;
	std::vector<FrameRecord> m_frames;
	Values m_values;
	SubstepGroup m_group;
	BroadphaseRecord m_broadphase;
	std::vector<GhostRecord> m_ghosts;
	std::vector<PairRecord> m_pairs;                      ///< those of ghosts come last
	std::vector<const PairContacts*> m_ours;              ///< of soft bodies, by their algorithms' addresses
	std::vector<const btPersistentManifold*> m_manifolds; ///< of the pairs in their order, when it writes
	std::vector<ManifoldRecord> m_contacts;               ///< the same, when it reads
	ManifoldOrder m_order;
	bool m_movesRigid = true;
};

} // namespace pliant
