// The names of the result codes, for logs.

#include "pliant/result.h"

namespace pliant {

const char* toString( ResultCode code )
{
	switch ( code )
	{
		case ResultCode::Ok: return "Ok";
		case ResultCode::EmptyMesh: return "EmptyMesh";
		case ResultCode::NonFiniteVertex: return "NonFiniteVertex";
		case ResultCode::IndexOutOfRange: return "IndexOutOfRange";
		case ResultCode::ExtentOutOfRange: return "ExtentOutOfRange";
		case ResultCode::ZeroVolume: return "ZeroVolume";
		case ResultCode::TooManyTriangles: return "TooManyTriangles";
		case ResultCode::TooManyCells: return "TooManyCells";
		case ResultCode::OutOfMemory: return "OutOfMemory";
		case ResultCode::Cancelled: return "Cancelled";
		case ResultCode::BadSettings: return "BadSettings";
		case ResultCode::BadMaterial: return "BadMaterial";
		case ResultCode::BadArgument: return "BadArgument";
		case ResultCode::TooFolded: return "TooFolded";
		case ResultCode::BadSnapshot: return "BadSnapshot";
	}
	return "unknown";
}

} // namespace pliant
