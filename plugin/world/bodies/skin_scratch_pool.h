#pragma once

// Scratch for skinning, lent to bodies by their world. One per body would be out of the cache at each use, a twentieth of the cost of
// skinning, and take three times the memory of the skins.

#include "surface/skin/skinning.h"

#include <memory>
#include <mutex>
#include <vector>

namespace pliant {

class SkinScratchPool
{
public:
	/// Returns its scratch to the pool on destruction.
	class Borrowed
	{
	public:
		/// `pool` null: the body is in no world, and the scratch is allocated.
		explicit Borrowed( SkinScratchPool* pool ) : m_pool( pool ), m_scratch( pool ? pool->take() : std::make_unique<SkinScratch>() ) {}
		~Borrowed()
		{
			if ( m_pool )
			{
				m_pool->giveBack( std::move( m_scratch ) );
			}
		}
		Borrowed( const Borrowed& ) = delete;
		Borrowed& operator=( const Borrowed& ) = delete;
		SkinScratch& operator*() const { return *m_scratch; }

	private:
		SkinScratchPool* m_pool;
		std::unique_ptr<SkinScratch> m_scratch;
	};

private:
	/// Returns the scratch that was given back last, which is most likely cached.
	std::unique_ptr<SkinScratch> take()
	{
		const std::lock_guard lock( m_lock );
		if ( m_free.empty() )
		{
			m_free.reserve( ++m_made ); // giveBack() then never allocates
			return std::make_unique<SkinScratch>();
		}
		std::unique_ptr<SkinScratch> scratch = std::move( m_free.back() );
		m_free.pop_back();
		return scratch;
	}
	void giveBack( std::unique_ptr<SkinScratch> scratch )
	{
		const std::lock_guard lock( m_lock );
		m_free.push_back( std::move( scratch ) );
	}

	std::mutex m_lock;
	std::size_t m_made = 0;
	std::vector<std::unique_ptr<SkinScratch>> m_free; ///< at most one per thread that has made skins at a time
};

} // namespace pliant
